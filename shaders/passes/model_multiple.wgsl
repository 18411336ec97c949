// R + TT, light scattered any number of times.

const PHYSICAL: bool = true;
const MULTIPLE: bool = true;

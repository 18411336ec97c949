// R + TT, light scattered once.

const PHYSICAL: bool = true;
const MULTIPLE: bool = false;

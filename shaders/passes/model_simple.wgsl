// Lambert and a highlight.

const PHYSICAL: bool = false;
const MULTIPLE: bool = false;

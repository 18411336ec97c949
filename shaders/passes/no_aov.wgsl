// Pictures without further passes.

fn add_aovs(index: u32, draw: u32, surface: Surface, shaded: Shaded) {}

fn add_mesh_aovs(index: u32, draw: u32, triangle: u32, position: vec3f, color: vec3f, shaded: Shaded) {}

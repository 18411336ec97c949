// Pictures without further passes.

fn add_aovs(index: u32, draw: u32, surface: Surface, shaded: Shaded) {}

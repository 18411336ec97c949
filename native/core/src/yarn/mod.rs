//! The procedural yarn: plies twisted around a yarn, fibers twisted around each ply [Zhao2016; WuYuksel2018 §2.2, §3.1].

mod curve;
mod fiber;
mod parameters;
mod presets;
mod table;

pub use curve::{Knot, Segment, YarnPoint};
pub use fiber::{
    Break, Fiber, FiberPoint, FiberProfile, FiberType, HAIR_WIDTH, PlyPoint, Twist, breaks, fiber_point, fiber_profile,
    fiber_seed, flyaway_type, period_type, ply_point,
};
pub use parameters::{Flyaways, Variate, Yarn, YarnError};
pub use presets::PRESET_NAMES;
pub use table::{FiberTable, acceptance, radial_density};

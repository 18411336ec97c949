// The thread model for a path tracer; twin of native/core/src/scattering/fiber.rs, where the contract is.

// `terms`: the tables of surface and volume at the viewer's angle.
fn thread_mixture(thread: Thread, terms: vec2f) -> Mixture {
    let volume = terms.y * mean_of(thread.color);
    return Mixture(array<Lobe, 3>(
        Lobe(terms.x, LOBE_CONE_UNIFORM, 2.0 * thread.surface_width, 0.0),
        Lobe(volume * (1.0 - thread.isotropic), LOBE_CONE_UNIFORM, 2.0 * thread.volume_width, 0.0),
        Lobe(volume * thread.isotropic, LOBE_EVEN, 0.0, 0.0),
    ));
}

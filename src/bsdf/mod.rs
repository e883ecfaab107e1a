//! Scattering at a surface.
//!
//! Conventions, the same for every model: all directions are unit vectors in the local frame whose z axis is the shading
//! normal on the surface's outer side; `wo` points back along the path, `wi` is the sampled direction, both leave the
//! surface. `f(wo, wi)` [sr^-1] carries no cosine; `pdf` is per solid angle. Perfectly specular models are delta
//! distributions: `f` and `pdf` are 0 for them and only `sample` answers.

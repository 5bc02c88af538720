#pragma once

namespace pliant {

/// The iteration that solves linear systems without a matrix. Conjugate gradients end at the first direction of no positive
/// curvature: what they have found so far is still a way down, so that Newton's method goes to a minimum of the potential
/// (Steihaug, SIAM Journal on Numerical Analysis 20 (1983) 626). MINRES solves systems of indefinite tangents, as factors do:
/// Newton's method then goes to the equilibrium nearby, which may be a saddle.
enum class KrylovMethod {
  automatic,  // conjugate gradients, and MINRES where their first direction has no positive curvature
  conjugate_gradients,  // alone: an Error where that is so
  minres
};

}  // namespace pliant

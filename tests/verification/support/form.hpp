#pragma once

namespace pliant::verification {

/// Whether the program has the full form of its problem, or --quick alone. What the quick form leaves out takes
/// longer to compile than the rest takes to run, so the tests do without it.
#if defined(PLIANT_QUICK_FORM_ALONE)
inline constexpr bool has_full_form = false;
#else
inline constexpr bool has_full_form = true;
#endif

}  // namespace pliant::verification

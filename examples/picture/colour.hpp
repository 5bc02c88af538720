#pragma once

namespace pliant::picture {

/// Red, green and blue, each from 0 to 1.
struct Colour {
  double r, g, b;
};

/// Stands apart from everything that `green_to_red` returns: elements that switched.
inline constexpr Colour blue{0.13, 0.40, 0.82};

/// Recedes behind the others: elements that are passed over.
inline constexpr Colour pale{0.80, 0.80, 0.80};

/// Green at 0, through yellow, to red at 1. Values outside take the colour of the nearer end.
/// A value that is not a number gives a colour that `write_strip` rejects.
Colour green_to_red(double value);

}  // namespace pliant::picture

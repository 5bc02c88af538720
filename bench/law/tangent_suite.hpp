#pragma once

#include "law/pairs.hpp"

// Tangent products of some laws as the library derives them, and of twins where all is by hand, or the
// stress is and one dual goes through it.
namespace pliant::bench {

inline void add_law_tangents() {
  add_pair<true, SaintVenantKirchhoff, by_hand::WithTangent<by_hand::SaintVenantKirchhoff>::law>(
      "SaintVenantKirchhoff", SaintVenantKirchhoff<double>::from(soft));
  add_pair<true, NeoHookean, by_hand::WithTangent<by_hand::NeoHookean>::law>(
      "NeoHookean", NeoHookean<double>::from(soft));
  add_pair<true, StableNeoHookean, by_hand::WithTangent<by_hand::StableNeoHookean>::law>(
      "StableNeoHookean", StableNeoHookean<double>::from(soft));
  add_pair<true, Yeoh, by_hand::Yeoh>("Yeoh", Yeoh<double>::from(soft, 0.2, 0.1));
  add_pair<true, Fung, by_hand::Fung>("Fung", Fung<double>::from(soft));
  add_pair<true, HolzapfelGasserOgden, by_hand::HolzapfelGasserOgden>("HolzapfelGasserOgden",
                                                                      {2, 1, 0.5, 0.1, 5});
}

}  // namespace pliant::bench

#pragma once

#include "law/pairs.hpp"

// Forces of each law as the library derives it, and of its twin whose stress is written by hand.
namespace pliant::bench {

inline void add_law_forces() {
  add_pair<false, Hooke, by_hand::Hooke>("Hooke", Hooke<double>::from(soft));
  add_pair<false, SaintVenantKirchhoff, by_hand::SaintVenantKirchhoff>(
      "SaintVenantKirchhoff", SaintVenantKirchhoff<double>::from(soft));
  add_pair<false, NeoHookean, by_hand::NeoHookean>("NeoHookean", NeoHookean<double>::from(soft));
  add_pair<false, StableNeoHookean, by_hand::StableNeoHookean>(
      "StableNeoHookean", StableNeoHookean<double>::from(soft));
  add_pair<false, IsochoricNeoHookean, by_hand::IsochoricNeoHookean>(
      "IsochoricNeoHookean", IsochoricNeoHookean<double>::from(soft));
  add_pair<false, SimoNeoHookean, by_hand::SimoNeoHookean>("SimoNeoHookean",
                                                           SimoNeoHookean<double>::from(soft));
  add_pair<false, MooneyRivlin, by_hand::MooneyRivlin>("MooneyRivlin",
                                                       MooneyRivlin<double>::from(soft));
  add_pair<false, Yeoh, by_hand::Yeoh>("Yeoh", Yeoh<double>::from(soft, 0.2, 0.1));
  add_pair<false, Gent, by_hand::Gent>("Gent", Gent<double>::from(soft, 10));
  add_pair<false, ArrudaBoyce, by_hand::ArrudaBoyce>("ArrudaBoyce",
                                                     ArrudaBoyce<double>::from(soft, 1.5));
  add_pair<false, Fung, by_hand::Fung>("Fung", Fung<double>::from(soft));
  add_pair<false, Guccione, by_hand::Guccione>("Guccione", {2, 4, 1, 2, 5});
  add_pair<false, HolzapfelGasserOgden, by_hand::HolzapfelGasserOgden>("HolzapfelGasserOgden",
                                                                       {2, 1, 0.5, 0.1, 5});
  add_pair<false, Ogden, by_hand::Ogden>("Ogden", Ogden<double>::from(soft));
  add_pair<false, Corotated, by_hand::Corotated>("Corotated", Corotated<double>::from(soft));
}

}  // namespace pliant::bench

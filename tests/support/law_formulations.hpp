#pragma once

// Every law on some element, for the suites over all formulations.
namespace pliant::test {

using LawFormulations =
    List<Formulation<Tet4, Gauss<1>, StableNeoHookean>,
         Formulation<Quad4, Gauss<2>, IsochoricNeoHookean>,
         Formulation<Tri6, Gauss<2>, SimoNeoHookean>, Formulation<Tet4, Gauss<1>, MooneyRivlin>,
         Formulation<Hex8, Gauss<2>, Yeoh>, Formulation<Tet4, Gauss<1>, Ogden>,
         Formulation<Quad4, Gauss<2>, ArrudaBoyce>, Formulation<Tri3, Gauss<1>, Gent>,
         Formulation<Tet4, Gauss<1>, Fung>, Formulation<Tet4, Gauss<1>, Corotated>,
         Formulation<Hex8, Gauss<2>, Guccione>, Formulation<Tet4, Gauss<1>, HolzapfelGasserOgden>,
         Formulation<Tri3, Gauss<1>, PerElement<NeoHookean>::law>,
         Formulation<Tri6, Gauss<2>, PlaneStress<Hooke>::law>,
         Formulation<Quad4, Gauss<2>, PlaneStress<NeoHookean>::law>,
         Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>,
         Formulation<Tet4, Gauss<1>, KelvinVoigt<StableNeoHookean>::law>>;
using FewLawFormulations =
    List<Formulation<Tet4, Gauss<1>, Guccione>, Formulation<Tri3, Gauss<1>, Ogden>,
         Formulation<Tri3, Gauss<1>, PlaneStress<NeoHookean>::law>,
         Formulation<Tet4, Gauss<1>, Prony<StableNeoHookean>::law>>;

template <>
struct Sample<Guccione<double>> {
  static constexpr Guccione<double> law{
      .c = 2, .fibre = 4, .transverse = 1, .shearing = 2, .bulk = 5};
  static constexpr std::array<double, 3> values{3, 4, 1};
};
template <>
struct Sample<HolzapfelGasserOgden<double>> {
  static constexpr HolzapfelGasserOgden<double> law{
      .mu = 2, .k1 = 1, .k2 = 0.5, .dispersion = 0.1, .bulk = 5};
  static constexpr std::array<double, 6> values{3, 4, 1, -3, 4, 1};
  static constexpr double smooth_at = 1.5;  // no fibre is shortened
};
template <>
struct Sample<PerElement<NeoHookean>::law<double>> {
  static constexpr std::array<double, 2> values{3, 2};
};
template <>
struct Sample<Prony<NeoHookean>::law<double>> {
  static inline Prony<NeoHookean>::law<double> const law{
      NeoHookean<double>::from(soft), {0.5}, {1}};
};
template <>
struct Sample<Prony<StableNeoHookean>::law<double>> {
  static inline Prony<StableNeoHookean>::law<double> const law{
      StableNeoHookean<double>::from(soft), {0.5}, {1}};
};
template <>
struct Sample<KelvinVoigt<StableNeoHookean>::law<double>> {
  static inline KelvinVoigt<StableNeoHookean>::law<double> const law{
      StableNeoHookean<double>::from(soft), 0.1};
};

}  // namespace pliant::test

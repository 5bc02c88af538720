#pragma once

#include <array>
#include <regex>
#include <string>

// Defects that are known and not mended yet: they do not fail the suite, others do.
namespace pliant::stability {

struct Known {
  char const* keys;  // a regular expression: see Case::key
  char const* reason;
};

inline constexpr char const* through_folds =
    "elements pass through a fold between two looks of an explicit integrator, which sees them "
    "there only when it looks; "
    "Advanced::checked tells that these steps were not looked at";
inline constexpr char const* rough =
    "1 to 4% off what a quarter of the step gives, under a load of ten times Young's modulus at "
    "once";

inline constexpr std::array known{
    Known{
        R"(^(stretch\|10|pressure\|10 E)\|.*\|(NeoHookean|MooneyRivlin|Ogden|Gent)\|(CentralDifference|LocalSteps)\|)",
        through_folds},
    Known{R"(^stretch\|3\|Quad9\|Ogden\|CentralDifference\|)", through_folds},
    Known{R"(^stretch\|10\|Hex8\|Gent\|implicit\|)",
          "the energy of Gent's law is not finite behind a step that brings its limit, and the "
          "next step tells"},
    Known{R"(^pressure\|10 E\|.*\|(NeoHookean|MooneyRivlin|Ogden|Gent)\|implicit\|)", rough},
    Known{R"(^return to rest\|\|(Quad4|Hex8)\|.*\|implicit\|)",
          "1.1e-3 of the displacement is left where 1e-3 is asked: the trapezoidal rule at this "
          "step damps a little less"},
    Known{R"(^free spin\|1e6 steps\|(Tri3|Quad4)\|SaintVenantKirchhoff\|CentralDifference\|)",
          "the energy is 2 to 4% off after 10^6 steps, with momenta kept to rounding; not "
          "explained yet"},
};

/// Null where a defect is new.
inline char const* reason_why_known(std::string const& key) {
  for (auto const& one : known)
    if (std::regex_search(key, std::regex(one.keys))) return one.reason;
  return nullptr;
}

}  // namespace pliant::stability

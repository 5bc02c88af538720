#pragma once

#include <pliant/config.hpp>

namespace pliant {

/// Leaves that are elements of another type than those in whose place they came: of another degree, or shape.
struct ConvertedFamily {
  Index cell = -1;          ///< the first that came, by its new number; the others follow it
  Index come = 0;           ///< how many came
  Index first_before = -1;  ///< the place before of the first that went; the others followed it
  Index gone = 0;           ///< how many went: one where several came
};

}  // namespace pliant

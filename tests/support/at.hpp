#pragma once

#include <cstddef>

#include <pliant/config.hpp>

namespace pliant::test {

inline std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace pliant::test

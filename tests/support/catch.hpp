#pragma once

// Catch2 version 3, or version 2, under the names that the tests use. The build makes the header of
// version 2 stand for both, so that one version serves all files.
#include <string>

#include <catch2/catch.hpp>

namespace pliant::test {

#if CATCH_VERSION_MAJOR >= 3
using Catch::Approx;
inline auto says(std::string const& part) { return Catch::Matchers::ContainsSubstring(part); }
#else
using ::Approx;
inline auto says(std::string const& part) { return Catch::Contains(part); }
#endif

}  // namespace pliant::test

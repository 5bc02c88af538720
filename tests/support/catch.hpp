#pragma once

// Catch2 version 3, or version 2, under the names that the tests use.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <string>

namespace pliant::test {

#if __has_include(<catch2/catch_all.hpp>)
using Catch::Approx;
inline auto says(std::string const& part) { return Catch::Matchers::ContainsSubstring(part); }
#else
using ::Approx;
inline auto says(std::string const& part) { return Catch::Contains(part); }
#endif

}  // namespace pliant::test

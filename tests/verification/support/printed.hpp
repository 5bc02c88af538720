#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

namespace pliant::verification {

/// A reference value, and how far from it a result may be.
struct Printed {
  double value, tolerance;
  std::string text;
};

/// A value as REFERENCES prints it: "14.523", "-66.103e-3", "4.166(3)". Its last digit, or the number in
/// brackets of these, is its tolerance.
inline Printed printed(std::string const& text) {
  auto const bracket = text.find('('), exponent = text.find('e');
  std::string const mantissa = text.substr(0, std::min(bracket, exponent));
  auto const point = mantissa.find('.');
  auto const decimals = point == std::string::npos ? 0 : mantissa.size() - point - 1;
  double const power =
      exponent == std::string::npos ? 0 : std::strtod(text.c_str() + exponent + 1, nullptr);
  double const units =
      bracket == std::string::npos ? 1 : std::strtod(text.c_str() + bracket + 1, nullptr);
  return {std::strtod(mantissa.c_str(), nullptr) * std::pow(10, power),
          units * std::pow(10, power - static_cast<double>(decimals)), text};
}

inline std::string number(double value, char const* format = "%.9g") {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// A value that is met to a tolerance of our own: closed forms, and numbers with more digits than matter.
inline Printed within(double tolerance, double value) {
  return {value, tolerance, number(value, "%.13g")};
}

}  // namespace pliant::verification

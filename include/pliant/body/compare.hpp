#pragma once

#include <pliant/body/member_bytes.hpp>
#include <pliant/body/state.hpp>

namespace pliant {

namespace detail {
/// Keeps the name of the first member that is not the same, to the bit.
struct CompareMember {
  std::string& different;

  template <class U>
  void operator()(char const* name, U const& a, U const& b) const {
    if (!different.empty()) return;
    if constexpr (HasMembers<U const>) {
      std::string within;
      U::for_each_member(CompareMember{within}, a, b);
      if (!within.empty()) different = message({name, ": ", within});
    } else {
      std::string one, other;
      ByteWriter(one).put(a);
      ByteWriter(other).put(b);
      if (one != other) different = name;
    }
  }
};
}  // namespace detail

/// The first member in which two states differ in a bit; "" where they are the same.
template <class S>
std::string first_difference(S const& a, S const& b) {
  std::string different;
  S::for_each_member(detail::CompareMember{different}, a, b);
  return different;
}
/// Whether two states are the same to the bit.
template <class S>
bool same_state(S const& a, S const& b) {
  return first_difference(a, b).empty();
}

}  // namespace pliant

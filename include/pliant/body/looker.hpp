#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

/// An Adaptation that has looked at a body.
struct Looker {
  std::uint64_t rules;                   // a key of its rules, which others may share
  std::weak_ptr<void const> adaptation;  // its identity
  double clock = 0;         // s: of a budget in milliseconds, when its last look ended,
  std::int64_t timed = -1;  // and at which step
};

}  // namespace pliant

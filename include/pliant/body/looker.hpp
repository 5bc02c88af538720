#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

/// An Adaptation that has looked at a body.
struct Looker {
  std::uint64_t rules;                   // a key of its rules, which others may share
  std::weak_ptr<void const> adaptation;  // its identity
};

}  // namespace pliant

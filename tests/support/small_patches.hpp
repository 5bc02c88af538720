#pragma once

#include <pliant/reference.hpp>

namespace pliant::test {

/// The serial backend with patches of `Size` elements, where those of 512 would hold all of a small mesh.
template <std::floating_point T, Index Size>
class SmallPatches : public Reference<T> {
 public:
  template <int Nodes>
  class Elements : public Reference<T>::template Elements<Nodes> {
    using Base = typename Reference<T>::template Elements<Nodes>;

   public:
    using Base::Base;
    static constexpr Index patch_size() { return Size; }
    Index patch_count() const { return (this->count() + Size - 1) / Size; }
  };
};

}  // namespace pliant::test

#pragma once

#include <cstddef>
#include <iterator>
#include <utility>

namespace pliant {

/// Goes over a list by its places, where items are no objects but views that list[i] makes.
template <class List>
class PlaceIterator {
 public:
  using iterator_concept = std::forward_iterator_tag;
  using iterator_category = std::input_iterator_tag;
  using value_type = decltype(std::declval<List const&>()[0]);
  using reference = value_type;
  using pointer = void;
  using difference_type = std::ptrdiff_t;

  PlaceIterator() = default;
  PlaceIterator(List const& list, std::size_t place) : list_(&list), place_(place) {}
  value_type operator*() const { return (*list_)[place_]; }
  PlaceIterator& operator++() {
    ++place_;
    return *this;
  }
  PlaceIterator operator++(int) { return {*list_, place_++}; }
  friend bool operator==(PlaceIterator const&, PlaceIterator const&) = default;

 private:
  List const* list_ = nullptr;
  std::size_t place_ = 0;
};

}  // namespace pliant

#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/math/place_iterator.hpp>

namespace pliant {

/// What adaptation did to a body's energy. Switching laws and refining are not physics: whatever
/// they add or take is written down.
template <std::size_t Dim>
struct LedgerEntry {
  double time;  // s; of the last action that it counts
  std::string action;
  double elements;                  // that acted
  double strain_energy;             // change, J
  double kinetic_energy;            // change, J
  std::array<double, Dim> impulse;  // given to held nodes, N s

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("time", r.time...);
    visit("action", r.action...);
    visit("elements", r.elements...);
    visit("strain energy", r.strain_energy...);
    visit("kinetic energy", r.kinetic_energy...);
    visit("impulse", r.impulse...);
  }
};

/// Entries, one after another, which copies share: a run that changes its mesh ten thousand times copies them with each change.
template <std::size_t Dim>
class LedgerEntries {
 public:
  using value_type = LedgerEntry<Dim>;

  [[nodiscard]] std::size_t size() const { return per_chunk * chunks_.size() + last_.size(); }
  value_type const& operator[](std::size_t i) const {
    std::size_t const chunk = i / per_chunk;
    return (chunk < chunks_.size() ? *chunks_[chunk] : last_)[i % per_chunk].entry;
  }
  [[nodiscard]] auto begin() const { return PlaceIterator(*this, 0); }
  [[nodiscard]] auto end() const { return PlaceIterator(*this, size()); }
  /// The changes of energies of all entries, J.
  [[nodiscard]] double energy() const {
    if (!last_.empty()) return last_.back().sum;
    return chunks_.empty() ? 0 : chunks_.back()->back().sum;
  }

  void push_back(value_type entry) {
    double const sum = energy() + (entry.strain_energy + entry.kinetic_energy);
    if (last_.size() == per_chunk) {
      chunks_.push_back(std::make_shared<Chunk const>(last_));
      last_.clear();
    }
    last_.push_back({std::move(entry), sum});
  }
  /// Takes the last one out.
  value_type take_back() {
    if (last_.empty()) {
      last_ = *chunks_.back();
      chunks_.pop_back();
    }
    auto entry = std::move(last_.back().entry);
    last_.pop_back();
    return entry;
  }
  void clear() { *this = {}; }

 private:
  struct Booked {
    value_type entry;
    double sum;  // J, of this one and all before it
  };
  using Chunk = std::vector<Booked>;
  static constexpr std::size_t per_chunk = 32;

  std::vector<std::shared_ptr<Chunk const>> chunks_;  // full ones
  Chunk last_;                                        // per_chunk at most
};

}  // namespace pliant

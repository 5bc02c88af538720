#pragma once

#include <bit>
#include <cstdint>

#include <pliant/cuda/fan_member.hpp>
#include <pliant/cuda/plan_threads.hpp>

namespace pliant::detail {

/// Splits the tetrahedra of a patch into fans. In rounds: each tetrahedron that is in none votes for the best of its
/// edges, and where all around an edge do, they become a fan, or several. Best is the edge whose fan visits fewest
/// nodes for an element; of these, the one whose tetrahedra lie closest together in the patch, so that cells which a
/// mesh generator has cut into tetrahedra are put together again.
class FanSplitter {
 public:
  static constexpr int most_nodes = 1024, most_elements = 1024;  // of a patch

  PLIANT_HOST_DEVICE FanSplitter(PlanMemory& memory, int patch_size)
      : members_(memory.take<FanMember>(most_fan_elements * patch_size)),
        home_(memory.take<std::uint16_t>(patch_size)),
        size_(memory.take<std::uint8_t>(patch_size)),
        end_(memory.used()),
        mask_(2 * static_cast<int>(std::bit_ceil(static_cast<unsigned>(patch_size))) - 1),
        key_(memory.take<int>(mask_ + 1)),
        around_(memory.take<int>(mask_ + 1)),
        votes_(memory.take<int>(mask_ + 1)),
        first_(memory.take<int>(mask_ + 1)),
        totals_(memory.take<int>(2)),
        edge_(memory.take<std::uint16_t>(6 * patch_size)),
        next_(memory.take<std::uint16_t>(6 * patch_size)),
        before_(memory.take<std::uint16_t>(patch_size)),
        after_(memory.take<std::uint16_t>(patch_size)),
        choice_(memory.take<std::uint8_t>(patch_size)),
        taken_(memory.take<std::uint8_t>(patch_size)),
        claimed_(memory.take<std::uint8_t>(patch_size)) {}

  /// Behind this, memory is free when the fans are known.
  PLIANT_HOST_DEVICE int end() const { return end_; }

  /// Of `size` elements whose corners' numbers in the patch, below most_nodes, are local[4 · size]. How many fans there
  /// are; those of most elements come first.
  template <class Threads>
  PLIANT_HOST_DEVICE int split(Threads const& threads, std::uint16_t const* local, int size) {
    local_ = local;
    find_edges(threads, size);
    for (int before = *left(); before > 0;) {
      share_out(threads, mask_ + 1, [&](int e) { around_[e] = votes_[e] = 0; });
      threads.meet();
      for_each_left(threads, size, [&](int t) {
        for (int q = 0; q < 6; ++q)
          add_shared(around_[edge_[6 * t + q]], summand(FanMember::of(t, q)));
      });
      threads.meet();
      for_each_left(threads, size, [&](int t) {
        int const q = best_edge(t);
        choice_[t] = static_cast<std::uint8_t>(q);
        add_shared(votes_[edge_[6 * t + q]], 1);
      });
      threads.meet();
      for_each_left(threads, size, [&](int t) { link(FanMember::of(t, choice_[t])); });
      threads.meet();
      for_each_left(threads, size, [&](int t) { make_fan(FanMember::of(t, choice_[t])); });
      threads.meet();
      for_each_left(threads, size, [&](int t) {
        if (claimed_[t] == 0) return;
        taken_[t] = 1;
        add_shared(*left(), -1);
      });
      threads.meet();
      int const now = *left();
      if (now == before) {  // an element has a node twice
        leave_alone(threads, size);
        break;
      }
      before = now;
    }
    threads.meet();
    return sort(threads, size);
  }

  PLIANT_HOST_DEVICE int size(int fan) const { return size_[home_[fan]]; }
  PLIANT_HOST_DEVICE FanMember member(int fan, int k) const {
    return members_[most_fan_elements * home_[fan] + k];
  }
  /// Of a member's corners, as the patch numbers them: both ends of the edge, then the corners where it follows the
  /// member before and precedes the next one; an even permutation of the element's own order.
  PLIANT_HOST_DEVICE int corner(FanMember member, int k) const { return member.corner(local_, k); }

 private:
  static constexpr int none = 0xffff;

  PLIANT_HOST_DEVICE int* left() const { return totals_; }      // elements in no fan
  PLIANT_HOST_DEVICE int* full() const { return totals_ + 1; }  // whether there are too many edges

  template <class Threads, class F>
  PLIANT_HOST_DEVICE void for_each_left(Threads const& threads, int size, F const& f) const {
    share_out(threads, size, [&](int t) {
      if (taken_[t] == 0) f(t);
    });
  }

  /// Each that no fan has becomes one.
  template <class Threads>
  PLIANT_HOST_DEVICE void leave_alone(Threads const& threads, int size) const {
    for_each_left(threads, size, [&](int t) { keep(FanMember::of(t, 0), t, 0, 1); });
  }

  /// Of what `around_` sums up: how many there are, and whether each one's end is another one's begin.
  static constexpr unsigned counted = 1 << 21;
  static constexpr int balance = 1024;
  PLIANT_HOST_DEVICE int summand(FanMember m) const {
    return static_cast<int>(counted) + balance + corner(m, 2) - corner(m, 3);
  }
  PLIANT_HOST_DEVICE static int members(int sum) {
    return static_cast<int>(static_cast<unsigned>(sum) / counted);
  }

  /// Of an edge: the fewer nodes a fan there visits for an element, the better.
  PLIANT_HOST_DEVICE std::int64_t rating(int edge) const {
    // 60 / 1, 60 / 2, ... 60 / most_fan_elements, a byte each, the first lowest
    constexpr std::uint64_t shares = 0x0a'0c'0f'14'1e'3c;
    int const sum = around_[edge], n = members(sum), most = most_fan_elements;
    bool const closed = n > 2 && n <= most &&
                        static_cast<unsigned>(sum) % counted == static_cast<unsigned>(balance * n);
    int const size = n < most ? n : most;
    int const visits_per_60 =
        (closed ? size + 2 : size + 3) * static_cast<int>(shares >> 8 * (size - 1) & 0xff);
    return std::int64_t{256 - visits_per_60} << 32 | key_[edge];
  }
  PLIANT_HOST_DEVICE int best_edge(int t) const {
    int best = 0;
    std::int64_t most = 0;
    for (int q = 0; q < 6; ++q)
      if (auto const r = rating(edge_[6 * t + q]); r > most) most = r, best = q;
    return best;
  }

  template <class Threads>
  PLIANT_HOST_DEVICE void find_edges(Threads const& threads, int size) {
    share_out(threads, mask_ + 1, [&](int e) {
      key_[e] = first_[e] = -1;
      around_[e] = size;
      votes_[e] = 0;
    });
    share_out(threads, size, [&](int t) { size_[t] = taken_[t] = claimed_[t] = 0; });
    if (threads.first() == 0) *left() = size, *full() = 0;
    threads.meet();
    share_out(threads, 6 * size, [&](int i) {
      auto const m = FanMember::of(i / 6, i % 6);
      int const e = find_or_insert(key_, mask_, corner(m, 0) << 10 | corner(m, 1));
      edge_[i] = static_cast<std::uint16_t>(e);
      if (e < 0) {
        raise_shared(*full(), 1);
        return;
      }
      lower_shared(around_[e], m.element());
      raise_shared(votes_[e], m.element());
      int const after = exchange_shared(first_[e], m.bits);
      next_[i] = static_cast<std::uint16_t>(after);
    });
    threads.meet();
    if (*full() != 0)  // so many edges are of elements that are not neighbours
      leave_alone(threads, size);
    // The key becomes the nearness of the edge's elements, and below that its number, shuffled.
    share_out(threads, mask_ + 1, [&](int e) {
      if (key_[e] < 0) return;
      int const apart = votes_[e] - around_[e];
      unsigned const shuffled = static_cast<unsigned>(key_[e]) * 0x9E37Bu & 0xfffffu;
      key_[e] = (most_elements - 1 - apart) << 20 | static_cast<int>(shuffled);
    });
    threads.meet();
    if (*full() != 0 && threads.first() == 0) *left() = 0;
    threads.meet();
  }

  /// Whether all around an edge have voted for it.
  PLIANT_HOST_DEVICE bool is_agreed(FanMember m) const {
    int const edge = edge_[6 * m.element() + m.edge()];
    return votes_[edge] == members(around_[edge]);
  }

  /// Finds the members before and behind one around such an edge; of several the first.
  PLIANT_HOST_DEVICE void link(FanMember own) const {
    int before = none, after = none;
    if (is_agreed(own)) {
      int const begin = corner(own, 2), end = corner(own, 3);
      for (int bits = first_[edge_[6 * own.element() + own.edge()]]; bits != none;) {
        FanMember const m{static_cast<std::uint16_t>(bits)};
        bits = next_[6 * m.element() + m.edge()];
        if (taken_[m.element()] != 0) continue;
        if (corner(m, 3) == begin && m.bits < before) before = m.bits;
        if (corner(m, 2) == end && m.bits < after) after = m.bits;
      }
    }
    before_[own.element()] = static_cast<std::uint16_t>(before);
    after_[own.element()] = static_cast<std::uint16_t>(after);
  }
  /// The member behind one, which it is before; or none.
  PLIANT_HOST_DEVICE int behind(FanMember m) const {
    int const next = after_[m.element()];
    return next != none && before_[next >> 3] == m.bits ? next : none;
  }
  /// Whether a fan begins with a member: the first of a row, or the one of a closed one that comes first in the patch.
  PLIANT_HOST_DEVICE bool begins(FanMember own) const {
    int const last = before_[own.element()];
    if (last == none || after_[last >> 3] != own.bits) return true;
    int next = behind(own);
    while (next != none && next > own.bits) next = behind({static_cast<std::uint16_t>(next)});
    return next == own.bits;
  }
  /// Of those that follow a member where all are linked, if a fan begins with it. Of more than a fan takes, the others are left.
  PLIANT_HOST_DEVICE void make_fan(FanMember own) const {
    if (!is_agreed(own) || !begins(own)) return;
    int size = 0, home = most_elements;
    auto const for_each_member = [&](auto const& f) {
      int k = 0;
      for (int next = own.bits; next != none && k < most_fan_elements; ++k) {
        FanMember const m{static_cast<std::uint16_t>(next)};
        f(m, k);
        next = behind(m);
        if (next == own.bits) next = none;
      }
    };
    for_each_member([&](FanMember m, int) {
      ++size;
      if (m.element() < home) home = m.element();
    });
    for_each_member([&](FanMember m, int k) { keep(m, home, k, size); });
  }

  PLIANT_HOST_DEVICE void keep(FanMember m, int home, int k, int size) const {
    members_[most_fan_elements * home + k] = m;
    size_[home] = static_cast<std::uint8_t>(size);
    claimed_[m.element()] = 1;
  }

  /// Homes by the sizes of their fans, then in their order; how many there are. All threads have met then.
  template <class Threads>
  PLIANT_HOST_DEVICE int sort(Threads const& threads, int size) const {
    // Numbers by sizes, side by side, the largest size lowest: only of single ones there may be as many as a field has no room for.
    constexpr int bits = 10, field = (1 << bits) - 1;
    auto const shift = [](int k) { return bits * (most_fan_elements - k); };
    // A run of elements for each thread: how many fans of each size are at home there, then their places.
    int const run = threads.first(), each = (size + threads.stride() - 1) / threads.stride();
    auto const for_each_home = [&](auto const& f) {
      for (int t = run * each; t < (run + 1) * each && t < size; ++t)
        if (size_[t] > 0) f(t, shift(size_[t]));
    };
    std::uint64_t own = 0, all = 0;
    for_each_home([&](int, int at) { own += std::uint64_t{1} << at; });
    std::uint64_t next = threads.sum_before(own, all);
    int fans = 0;
    for (int k = most_fan_elements; k > 0; --k) {
      next += static_cast<std::uint64_t>(fans) << shift(k);
      fans += static_cast<int>(k > 1 ? all >> shift(k) & field : all >> shift(k));
    }
    for_each_home([&](int t, int at) {
      home_[next >> at & field] = static_cast<std::uint16_t>(t);
      next += std::uint64_t{1} << at;
    });
    threads.meet();
    return fans;
  }

  std::uint16_t const* local_ = nullptr;  // (elements, 4)
  FanMember* members_;                    // (elements, most_fan_elements): of the fan at home there
  std::uint16_t* home_;                   // (fans): the first of its elements
  std::uint8_t* size_;                    // (elements): of the fan at home there; 0: none
  int end_;
  int mask_;
  int *key_, *around_, *votes_, *first_;  // (table), of edges; the first of a list of members
  int* totals_;
  std::uint16_t *edge_, *next_;  // (elements, 6): where in the table; the next in the edge's list
  std::uint16_t *before_, *after_;  // (elements): members around the chosen edge; or none
  std::uint8_t *choice_, *taken_,
      *claimed_;  // (elements): a fan has it since an earlier round, or this one
};

}  // namespace pliant::detail

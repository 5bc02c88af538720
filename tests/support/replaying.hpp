#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <pliant/pliant.hpp>

#include "support/catch.hpp"
#include "support/small_patches.hpp"

namespace pliant::test {

/// The serial backend with recordings as a GPU's: what is queued while one is made runs when it is replayed, with the
/// arguments of then. Visitors may add to nodes, as there.
template <std::floating_point T, Index Size>
class Replaying : private SmallPatches<T, Size> {
  using Verbs = SmallPatches<T, Size>;
  using Queue = std::vector<std::function<void()>>;

 public:
  using scalar = T;
  template <class U>
  using Array = HostArray<U>;
  using Timer = HostTimer;
  static constexpr bool orders_by_group = false;
  static constexpr char const* name() { return "Replaying"; }
  template <int Nodes>
  class Elements : public Verbs::template Elements<Nodes> {
   public:
    Elements() = default;
    Elements(Replaying const& backend, std::vector<std::array<Index, Nodes>> const& connectivity,
             int groups, std::vector<Tag> const& tags, Index nodes, NodeOrder order)
        : Verbs::template Elements<Nodes>(backend, connectivity, groups, tags, nodes, order) {}
  };

  class Recording {
   public:
    Recording() = default;
    explicit Recording(Queue queue) : queue_(std::move(queue)) {}
    void replay(int n) const {
      for (int k = 0; k < n; ++k)
        for (auto const& call : queue_) call();
    }

   private:
    Queue queue_;
  };

  Recording record(std::function<void()> const& f) const {
    queue_->emplace();
    f();
    Recording const made(std::move(**queue_));
    queue_->reset();
    return made;
  }

  template <class F>
  void for_each(Index n, F const& f) const {
    run([=, *this] { Verbs::for_each(n, f); });
  }
  template <class F>
  double sum(Index n, F const& f) const {
    REQUIRE(!*queue_);
    return Verbs::sum(n, f);
  }
  template <class F>
  void add_sum(Index n, F const& f, double* to) const {
    run([=, *this] { Verbs::add_sum(n, f, to); });
  }
  template <class F>
  double maximum(Index n, F const& f) const {
    REQUIRE(!*queue_);
    return Verbs::maximum(n, f);
  }
  template <class F>
  std::vector<Index> select(Index n, F const& f) const {
    REQUIRE(!*queue_);
    return Verbs::select(n, f);
  }
  template <class F>
  void select(Index n, F const& f, Index* to, Index* count) const {
    run([=, *this] { Verbs::select(n, f, to, count); });
  }
  template <class F>
  void scan(Index n, F const& f, Index* to) const {
    run([=, *this] { Verbs::scan(n, f, to); });
  }
  void sort(Index n, std::uint64_t* keys, Index* values, int bits) const {
    run([=, *this] { Verbs::sort(n, keys, values, bits); });
  }
  template <class F>
  void histogram(Index n, F const& f, std::int64_t* bins) const {
    run([=, *this] { Verbs::histogram(n, f, bins); });
  }
  template <class U>
  Array<U> array(std::size_t count) const {
    return Array<U>(count);
  }
  void synchronize() const {}
  Timer timer() const { return {}; }

  template <int Groups, class Table, class Kernel, int C, class... Fields>
  void accumulate(Table const& table, Kernel const& kernel, NodeField<T, C> out,
                  Fields const&... fields) const {
    run([=, *this, active = detail::active(table)] {
      Verbs::template accumulate<Groups>(active, kernel, out, fields...);
    });
  }
  template <int Groups, class Table, class Kernel, class... Fields>
  double sum_elements(Table const& table, Kernel const& kernel, Fields const&... fields) const {
    REQUIRE(!*queue_);
    return Verbs::template sum_elements<Groups>(table, kernel, fields...);
  }
  template <int Groups, class Table, class Visitor, class... Fields>
  void visit(Table const& table, Visitor const& visitor, HostArray<double>& counters,
             Fields const&... fields) const {
    run([=, *this, active = detail::active(table), tallies = &counters] {
      Verbs::template visit<Groups>(active, Adding<Visitor>{visitor}, *tallies, fields...);
    });
  }

 private:
  /// Whose `again` adds to nodes.
  template <class Again>
  struct AtNodes : Again {
    template <int C, int Nodes>
    void add(NodeField<T, C> const& out, Matrix<T, Nodes, C> const& shares) const {
      for (int a = 0; a < Nodes; ++a)
        for (int k = 0; k < C; ++k) out(this->nodes[a], k) += shares(a, k);
    }
  };
  template <class Visitor>
  struct Adding : Visitor {
    template <class Group, class Values, class Again, class Tally>
    void finish(Group group, Index e, Values const& found, Again const& again,
                Tally const& tally) const {
      Visitor::finish(group, e, found, AtNodes<Again>{again}, tally);
    }
  };
  template <class Call>
  void run(Call call) const {
    if (*queue_)
      (*queue_)->push_back(std::move(call));
    else
      call();
  }

  std::shared_ptr<std::optional<Queue>> queue_ = std::make_shared<std::optional<Queue>>();
};

}  // namespace pliant::test

#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/awake_set.hpp>
#include <pliant/body/patch_node_passes.hpp>
#include <pliant/constraint/rows_on.hpp>

// Which nodes belong to which patches, and into which pieces these fall.
namespace pliant::detail {

template <class Parts>
std::size_t patch_count(Parts& parts) {
  std::size_t count = 0;
  parts.for_each_type(
      [&](auto& table, auto&) { count += static_cast<std::size_t>(table.elements.patch_count()); });
  return count;
}

/// Finds the patches of nodes from the elements in a backend's memory, and there.
template <class Parts>
class PatchNodesMaker {
  using B = typename Parts::backend_type;
  template <class U>
  using Array = typename B::template Array<U>;

 public:
  explicit PatchNodesMaker(Parts& parts) : parts_(parts), backend_(parts.backend) {}

  PatchNodes<B> operator()() {
    made_.first = zeros<Index>(backend_, at(parts_.layout.rows) + 1);
    list_visits();
    put_members();
    join_members();
    number_pieces();
    list_neighbours();
    auto const pieces = at(made_.pieces_count());
    made_.driven = zeros<std::uint8_t>(backend_, pieces);
    made_.stirred = zeros<std::uint8_t>(backend_, pieces);
    made_.turns = zeros<std::uint8_t>(backend_, at(made_.count()));
    return std::move(made_);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class U = Index>
  auto room(Index count) {
    return unset<U>(backend_, at(count));
  }
  /// An entry of an array of numbers.
  Index entry(Array<Index> const& numbers, Index i) {
    auto one = room(1);
    backend_.for_each(1, CopyValue<Index>{numbers.data() + i, one.data()});
    return download<Index>(one)[0];
  }
  [[nodiscard]] VisitArrays visits() {
    return {nodes_.data(), order_.data(), patch_of_visit_.data(), leader_.data()};
  }

  void list_visits() {
    auto const& slaves = parts_.layout.interpolation.slaves();
    auto slave_at = zeros<Index>(backend_, slaves.count > 0 ? at(parts_.layout.rows) : 0);
    MastersOfNodes masters;
    if (slaves.count > 0) {
      backend_.for_each(slaves.count, NumberSlavesByRow{slaves.node.data(), slave_at.data()});
      masters = {slave_at.data(), slaves.first.data(), slaves.other.data()};
    }
    std::vector<Array<Index>> starts;  // by type
    auto const of = [&]<class Table>(Table const& table) {
      return CountVisits{table.elements.rows_of_nodes(), Table::element::nodes, masters};
    };
    made_.first_of_type = {0};
    std::vector<Index> first_visit{0};
    parts_.for_each_type([&](auto& table, auto&) {
      auto& start = starts.emplace_back(room(table.count() + 1));
      backend_.scan(table.count(), of(table), start.data());
      first_visit.push_back(first_visit.back() + entry(start, table.count()));
      made_.first_of_type.push_back(made_.first_of_type.back() + table.elements.patch_count());
    });
    count_ = first_visit.back();
    nodes_ = room<std::uint64_t>(count_);
    order_ = room(count_);
    patch_of_visit_ = room(count_);
    leader_ = room(count_);
    std::size_t type = 0;
    parts_.for_each_type([&](auto& table, auto&) {
      backend_.for_each(table.count(),
                        ListVisits{of(table), table.elements.patches(), made_.first_of_type[type],
                                   first_visit[type], starts[type].data(), visits()});
      ++type;
    });
    backend_.synchronize();  // before starts and masters go
  }
  void put_members() {
    auto before = room(count_ + 1);
    member_ = room(count_);
    patch_of_member_ = room(count_);
    in_turn(backend_, SortStep{count_, nodes_.data(), order_.data(), key_bits(parts_.layout.rows)},
            ScanStep{count_, IsFirstOfMember{visits()}, before.data()},
            LoopStep{count_,
                     PutMembers{visits(),
                                before.data(),
                                {nodes_.data(), 0, count_, parts_.layout.rows, made_.first.data()},
                                member_.data(),
                                patch_of_member_.data()}});
    members_ = entry(before, count_);
  }
  void join_members() {
    piece_ = room(members_);
    backend_.for_each(members_, BeginPieces{piece_.data()});
    auto changed = zeros<Index>(backend_, 1);
    Index const none[]{0};
    do {
      changed.upload(none);
      in_turn(backend_,
              LoopStep{count_,
                       JoinMembers{member_.data(), leader_.data(), piece_.data(), changed.data()}},
              LoopStep{members_, FollowPieces{piece_.data()}});
    } while (download<Index>(changed)[0] != 0);
  }
  void number_pieces() {
    Index const patches = made_.count();
    auto own = room(patches), before = room(members_ + 1), number = room(members_);
    auto* const of = patch_of_member_.data();
    BeginsOther const begins{piece_.data(), of, own.data()};
    in_turn(backend_,
            LoopStep{patches, FillValue<Index>{own.data(), std::numeric_limits<Index>::max()}},
            LoopStep{members_, FindOwnPieces{piece_.data(), of, own.data()}},
            ScanStep{members_, begins, before.data()});
    Index const others = entry(before, members_);
    made_.patch = room(patches + others);
    auto keys = room<std::uint64_t>(others);
    auto members = room(others);
    made_.first_other = room(patches + 1);
    made_.pieces = room(members_);
    in_turn(
        backend_,
        LoopStep{members_, ListOthers{begins, before.data(), keys.data(), members.data()}},
        SortStep{others, keys.data(), members.data(), key_bits(patches)},
        LoopStep{patches + 1, FillValue<Index>{made_.first_other.data(), patches}},
        LoopStep{patches, NumberOwnPieces{own.data(), number.data(), made_.patch.data()}},
        LoopStep{others, NumberOtherPieces{keys.data(), members.data(), patches, number.data(),
                                           made_.patch.data()}},
        LoopStep{others, BoundsOfOthers{{keys.data(), 0, others, patches, made_.first_other.data()},
                                        patches}},
        LoopStep{members_, PutPieces{piece_.data(), number.data(), made_.pieces.data()}});
    backend_.synchronize();  // before these lists go
  }
  void list_neighbours() {
    Index const rows = parts_.layout.rows, pieces = made_.pieces_count();
    auto start = room(rows + 1);
    backend_.scan(rows, CountMeetings{made_.first.data()}, start.data());
    Index const count = entry(start, rows);
    auto keys = room<std::uint64_t>(count);
    auto order = room(count), before = room(count + 1);
    int const bits = key_bits(pieces);
    in_turn(backend_,
            LoopStep{rows, ListMeetings{made_.first.data(), made_.pieces.data(), start.data(), bits,
                                        keys.data(), order.data()}},
            SortStep{count, keys.data(), order.data(), 2 * bits},
            ScanStep{count, IsFirstOfKey{keys.data()}, before.data()});
    made_.beside = room(entry(before, count));
    made_.first_beside = zeros<Index>(backend_, at(pieces) + 1);
    backend_.for_each(count,
                      PutBeside{keys.data(),
                                bits,
                                before.data(),
                                {keys.data(), bits, count, pieces, made_.first_beside.data()},
                                made_.beside.data()});
    backend_.synchronize();  // before the keys go
  }

  Parts& parts_;
  B const& backend_;
  PatchNodes<B> made_;
  Index count_ = 0, members_ = 0;
  Array<std::uint64_t> nodes_;  // see VisitArrays
  Array<Index> order_, patch_of_visit_, leader_;
  Array<Index> member_, patch_of_member_, piece_;
};

/// The patches of a body's elements, by internal numbers.
template <class Parts>
PatchNodes<typename Parts::backend_type> make_patch_nodes(Parts& parts) {
  return PatchNodesMaker<Parts>(parts)();
}

}  // namespace pliant::detail

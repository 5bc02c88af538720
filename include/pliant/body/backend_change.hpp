#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/body/changed_elements_on.hpp>
#include <pliant/body/changed_nodes_on.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/transfer.hpp>

// A change of a mesh, for values of nodes and elements in a backend's memory.
namespace pliant {

namespace detail {

/// What became of nodes and elements in a change that was made in a backend's memory.
template <class M, Backend B>
struct ChangedOn;
template <Element... Es, Backend B>
struct ChangedOn<Mesh<Es...>, B> {
  ChangedNodesOn<B> nodes;
  std::array<ElementOriginsOn<B>, sizeof...(Es)> elements{};  // by type
};

}  // namespace detail

/// A change of a mesh, as listeners of Body::on_backend_change get it, who keep values of nodes and elements in the backend's memory,
/// by the user's numbers. Valid during the call.
template <class M, Backend B>
class BackendChange {
 public:
  template <class U>
  using Array = typename B::template Array<U>;

  /// One that the host made.
  BackendChange(B const& backend, Transfer<M::dim> const& transfer)
      : backend_(backend), transfer_(&transfer) {}
  /// One that was made in the backend's memory.
  BackendChange(B const& backend, detail::ChangedOn<M, B> const& there)
      : backend_(backend), there_(&there) {}

  [[nodiscard]] Index nodes_before() const {
    return there_ != nullptr ? there_->nodes.before : transfer_->old_nodes();
  }
  [[nodiscard]] Index nodes() const {
    return there_ != nullptr ? there_->nodes.now : transfer_->nodes();
  }
  /// Of a type, by its place among the mesh's.
  [[nodiscard]] Index elements_before(std::size_t type = 0) const {
    return there_ != nullptr ? there_->elements.at(type).before
                             : static_cast<Index>(transfer_->old_elements(type));
  }
  [[nodiscard]] Index elements(std::size_t type = 0) const {
    return there_ != nullptr ? there_->elements.at(type).now
                             : static_cast<Index>(transfer_->elements(type));
  }

  /// Values of nodes on the new mesh, as Transfer::carry_nodes gives them: `now`, (nodes(), components), of `before`,
  /// (nodes_before(), components), floating-point numbers in the backend's memory. Waits for the backend only where the host made
  /// the change. Throws Error for less than one component.
  template <class U>
  void carry_nodes(U const* before, U* now, int components = 1) const {
    if (components < 1)
      throw Error("carry_nodes: ", components, " components; give how many each node has");
    if (there_ != nullptr)
      carry_there(before, now, components);
    else
      carry_by_host(before, now, at(components));
  }
  /// The same of an array. Throws Error, too, for one that is not of the mesh before.
  template <class U>
  [[nodiscard]] Array<U> carry_nodes(Array<U> const& before, int components = 1) const {
    auto const wanted = at(nodes_before()) * at(components);
    if (before.size() != wanted)
      throw Error("carry_nodes: got ", before.size(),
                  " values of nodes, but those before the change take ", wanted,
                  "; give the array from before it");
    auto now = unset<U>(backend_, at(nodes()) * at(components));
    carry_nodes(before.data(), now.data(), components);
    return now;
  }
  /// Values of the elements of one type, (elements_before(type), width), on the new mesh, (elements(type), width), as
  /// Transfer::carry_elements gives them. Waits for the backend only where the host made the change. Throws Error for an array that
  /// is not of the mesh before, a width of less than one, and where elements come from another type.
  template <class U>
  [[nodiscard]] Array<U> carry_elements(Array<U> const& before, std::size_t type = 0,
                                        int width = 1) const {
    return carry_elements_from<U>(type, width, [&](std::size_t old_type) -> Array<U> const& {
      if (old_type != type)
        throw Error("carry_elements: elements of type ", type, " come from type ", old_type,
                    "; give the values of all types");
      return before;
    });
  }
  /// The same where elements may come from other types: `before` has an array of each.
  template <class U>
  [[nodiscard]] Array<U> carry_elements(std::vector<Array<U>> const& before, std::size_t type,
                                        int width = 1) const {
    return carry_elements_from<U>(
        type, width, [&](std::size_t old_type) -> Array<U> const& { return before.at(old_type); });
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  template <class U>
  void carry_there(U const* before, U* now, int components) const {
    auto const numbers = there_->nodes.new_numbers();
    backend_.for_each(there_->nodes.before,
                      detail::MoveNodeValues<U>{numbers, components, before, now});
    fill_new_nodes(static_cast<M*>(nullptr), now, components);
  }
  template <Element... Es, class U>
  void fill_new_nodes(Mesh<Es...>*, U* values, int components) const {
    auto const& nodes = there_->nodes;
    (backend_.for_each(nodes.new_nodes,
                       detail::CarryNewNodes<Es, U>{nodes.tree, nodes.made, sizeof...(Es) > 1,
                                                    components, values}),
     ...);
  }
  /// `before`(type): the values of the elements of a type before the change.
  template <class U, class Before>
  Array<U> carry_elements_from(std::size_t type, int width, Before const& before) const {
    if (width < 1)
      throw Error("carry_elements: a width of ", width, "; give how many values each element has");
    auto const checked = [&](std::size_t old_type) -> Array<U> const& {
      auto const& values = before(old_type);
      if (auto const wanted = at(elements_before(old_type)) * at(width); values.size() != wanted)
        throw Error("carry_elements: got ", values.size(), " values of elements of type ", old_type,
                    ", but those before the change take ", wanted,
                    "; give the array from before it");
      return values;
    };
    if (there_ != nullptr) {
      auto const& own = there_->elements.at(type);
      auto const& values = checked(type);
      return own.carry(backend_, values, width,
                       own.come_from_others() ? checked(own.other_type).data() : nullptr);
    }
    std::deque<std::vector<U>> lists;
    return upload(backend_, transfer_->carry_elements_from(
                                [&](std::size_t old_type) -> std::vector<U> const& {
                                  return lists.emplace_back(download<U>(checked(old_type)));
                                },
                                type, at(width)));
  }

  template <class U>
  void carry_by_host(U const* before, U* now, std::size_t components) const {
    auto own = unset<U>(backend_, at(nodes_before()) * components);
    detail::copy_values<B, U>(backend_, before, own.data(), own.size());
    auto const all = download<U>(own);
    std::vector<U> carried(at(nodes()) * components);
    for (std::size_t c = 0; c < components; ++c) {
      std::vector<U> values(at(nodes_before()));
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = all[components * i + c];
      values = transfer_->carry_nodes(std::move(values));
      for (std::size_t i = 0; i < values.size(); ++i) carried[components * i + c] = values[i];
    }
    own = upload(backend_, carried);
    detail::copy_values<B, U>(backend_, own.data(), now, carried.size());
  }

  B const& backend_;
  Transfer<M::dim> const* transfer_ = nullptr;
  detail::ChangedOn<M, B> const* there_ = nullptr;
};

}  // namespace pliant

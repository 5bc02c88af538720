#pragma once

#include <pliant/body/body.hpp>

// Members of Body: its elements and their groups.
namespace pliant {

template <Backend B, class M, class... Fs>
template <Element E>
std::vector<Tag> Body<B, M, Fs...>::groups_of() const {
  auto const& table = layout_.template table<E>();
  auto const internal = download<Tag>(table.elements.tags());
  std::vector<Tag> tags(internal.size());
  for (std::size_t e = 0; e < tags.size(); ++e)
    tags[static_cast<std::size_t>(table.user_element[e])] = internal[e];
  return tags;
}

template <Backend B, class M, class... Fs>
template <Element E>
ElementStart Body<B, M, Fs...>::first_elements_of(std::size_t count) const {
  ElementStart start{std::vector<Tag>(count, 0), {}};
  std::vector<std::vector<double>> columns;  // by value
  auto const take = [&]<class F>(Group<F> const& group) {
    if constexpr (std::same_as<typename F::element, E> && element_values<F> > 0) {
      if (group.values.size() != count && group.values.size() != 1)
        throw Error("body: a group's law reads ", element_values<F>,
                    " values per element; give values for 1 or for all ", count, " ", E::name(),
                    " elements, not for ", group.values.size());
      for (std::size_t k = 0; k < element_values<F>; ++k) {
        columns.emplace_back(count);
        for (std::size_t e = 0; e < count; ++e) {
          double const x = group.values[group.values.size() == 1 ? 0 : e][k];
          if (!std::isfinite(x))
            throw Error("body: value ", k, " of ", E::name(), " element ", e,
                        " is not finite; mend the group's values");
          columns.back()[e] = x;
        }
      }
      auto const law = group.law_for(material_);
      for (std::size_t e = 0; e < group.values.size(); ++e) {
        Vector<double, element_values<F>> row;
        for (int k = 0; k < element_values<F>; ++k)
          row[k] = group.values[e][static_cast<std::size_t>(k)];
        detail::check_law(law.at(row), {"the law of ", E::name(), " element ", e});
      }
    }
  };
  std::apply([&](auto const&... group) { (take(group), ...); }, groups_);
  for (std::size_t e = 0; e < count; ++e)
    for (auto const& column : columns) start.values.push_back(column[e]);
  return start;
}

template <Backend B, class M, class... Fs>
template <class F>
void Body<B, M, Fs...>::assign(std::vector<Index> const& elements) {
  using E = typename F::element;
  auto& table = layout_.template table<E>();
  constexpr int group = std::remove_reference_t<decltype(table)>::template group_of<F>;
  static_assert(group < std::remove_reference_t<decltype(table)>::groups,
                "assign<F>: this body has no Group<F>");
  std::vector<Tag> user = groups_of<E>();
  for (Index e : elements) {
    if (e < 0 || e >= table.count())
      throw Error("body.assign: there is no ", E::name(), " element ", e,
                  "; they are numbered 0 to ", table.count() - 1);
    user[static_cast<std::size_t>(e)] = static_cast<Tag>(group);
  }
  synchronize_velocities();
  std::vector<Tag> internal(user.size());
  for (std::size_t e = 0; e < user.size(); ++e)
    internal[e] = user[static_cast<std::size_t>(table.user_element[e])];
  if (auto& statistics = table.statistics; statistics.open || steps_ > history_.born) {
    if (!statistics.open) statistics.start(backend_, table.count(), history_.born);
    statistics.enter(download<Tag>(table.elements.tags()), internal, steps_);
  }
  using Table = std::remove_reference_t<decltype(table)>;
  auto const before = upload(backend_, download<Tag>(table.elements.tags()));
  table.elements.tags().upload(internal);
  table.elements.regroup();
  if constexpr (Table::Laws::internal_variable_count > 0)
    backend_.template visit<Table::groups>(
        table.elements, CarryInternalVariables<T, typename Table::Laws>{table.laws, before.data()},
        table.no_counters, rest_field(), std::as_const(*this).displacement_field());
  checkpoint_.reset();
  forget_forces();
}

}  // namespace pliant

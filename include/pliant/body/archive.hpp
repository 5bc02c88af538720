#pragma once

#include <cstdint>

#include <pliant/body/change_topology.hpp>
#include <pliant/body/checksum.hpp>
#include <pliant/body/leapfrog_energy.hpp>
#include <pliant/body/member_bytes.hpp>
#include <pliant/body/signature.hpp>
#include <pliant/body/sleep.hpp>
#include <pliant/constraint/press.hpp>

// States in binary streams, in the byte order of the machine:
//   magic (8 bytes)  version (4)  length of the content (8)  content  checksum of all before (8)
// The content is the body's signature, its state and the checkpoint, member by member.
namespace pliant {

namespace detail {

inline constexpr std::string_view archive_magic{"PLIANT\r\n", 8};
inline constexpr std::uint32_t archive_version = 22;

/// Writes members of a state. The first mesh is not written: the body has it.
template <class M>
struct WriteMember {
  ByteWriter write;
  WhenAsked<Topology<M>> known;

  void operator()(char const*, WhenAsked<Topology<M>> const& topology) const {
    bool const same = topology.get() == known.get();
    write.put(same);
    if (!same) write.put(topology);
  }
  template <class U>
  void operator()(char const*, U const& member) const {
    write.put(member);
  }
};
/// Reads them.
template <class B, class M>
struct ReadMember {
  ByteReader<B> read;
  WhenAsked<Topology<M>> known;

  void operator()(char const*, WhenAsked<Topology<M>>& topology) const {
    bool same = false;
    read.get(same);
    if (same)
      topology = known;
    else
      read.get(topology);
  }
  template <class U>
  void operator()(char const*, U& member) const {
    read.get(member);
  }
};

/// Gives conditions that were read the motions that the body was given under their names.
template <int Dim>
std::shared_ptr<Prescribed<Dim> const> with_motions(
    Prescribed<Dim> prescribed, std::map<std::string, Motion<Dim>> const& motions) {
  for (auto& condition : prescribed.conditions) {
    if (condition.name.empty()) continue;
    auto const found = motions.find(condition.name);
    if (found == motions.end())
      throw Error("body.load: nodes are driven by a motion called \"", condition.name,
                  "\", which this body was not given; call drive with this name first (and release "
                  "it, if you like)");
    condition.motion = found->second;
  }
  return std::make_shared<Prescribed<Dim> const>(std::move(prescribed));
}

/// Throws Error where the members of a state do not fit each other.
template <class State, class Layout>
void check_sizes(State const& state, Layout const& layout) {
  auto const demand = [](bool holds) {
    if (!holds) throw Error("body.load: the members of the state contradict each other");
  };
  std::size_t const rows = layout.rest.size();
  demand(state.u.size() == rows && state.v.size() == rows);
  demand(state.load.size() == 0 || state.load.size() == rows);
  demand(state.work.size() == static_cast<std::size_t>(Work::count));
  auto const& steps = state.implicit;
  for (auto const* field :
       {&steps.a, &steps.d_before, &steps.v_before, &steps.error_u, &steps.error_v, &steps.error_a,
        &steps.error_d_before, &steps.error_v_before})
    demand(field->size() == 0 || field->size() == rows);
  auto const types = std::tuple_size_v<decltype(layout.tables)>;
  demand(state.record.totals.empty() || state.record.totals.size() == types);
  std::size_t type = 0;
  auto const check_type = [&]<class Table>(Table const& table, auto const& elements) {
    auto const count = static_cast<std::size_t>(table.count());
    constexpr std::size_t counters = CounterLayout<Table::groups>::count;
    auto const& statistics = elements.statistics;
    demand(elements.tags.size() == count);
    for (Tag tag : download<Tag>(elements.tags)) demand(tag < Table::groups || tag == no_group);
    demand(elements.internal_variables.size() == count * Table::Laws::internal_variable_count);
    demand(elements.step_levels.size() == 0 || elements.step_levels.size() == count);
    demand(elements.step_distortions.size() == elements.step_levels.size());
    for (StepLevel level : download<StepLevel>(elements.step_levels))
      demand(level <= most_step_levels);
    demand(statistics.since.size() == (statistics.open ? count : 0));
    demand(statistics.switches.size() == (statistics.open ? count : 0));
    demand(statistics.counters.size() == (statistics.open ? counters : 0));
    demand(state.record.totals.empty() || state.record.totals[type++].size() == counters);
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (check_type(std::get<I>(layout.tables), std::get<I>(state.elements)), ...);
  }(std::make_index_sequence<std::tuple_size_v<decltype(layout.tables)>>());
  auto const check_nodes = [&](auto const& nodes) {
    for (Index node : nodes) demand(node >= 0 && node < layout.nodes());
  };
  for (auto const& condition : state.prescribed->conditions) check_nodes(condition.nodes);
  for (auto const& pressure : state.prescribed->pressures)
    for (auto const& facet : pressure.facets) check_nodes(facet);
}

/// Throws Error where rows are not those of so many nodes.
inline void check_rows(NodeRows const& rows, Index nodes) {
  bool fits = rows.of_node.size() == static_cast<std::size_t>(nodes) &&
              rows.region.size() <= rows.node.size();
  std::size_t taken = 0;
  for (Index const node : rows.node) taken += node >= 0;
  fits = fits && taken == rows.of_node.size();
  for (std::size_t i = 0; fits && i < rows.of_node.size(); ++i) {
    Index const row = rows.of_node[i];
    fits = row >= 0 && row < rows.count() &&
           rows.node[static_cast<std::size_t>(row)] == static_cast<Index>(i);
  }
  if (!fits) throw Error("body.load: the rows of the state are not those of its nodes");
}

/// Reads so many bytes, or as many as there are: memory is asked for as they come.
template <class Stream>
std::string read_bytes(Stream& stream, std::uint64_t count) {
  constexpr std::uint64_t piece = std::uint64_t{1} << 20;
  std::string bytes;
  while (bytes.size() < count && stream) {
    auto const before = bytes.size();
    bytes.resize(before + static_cast<std::size_t>(std::min(piece, count - before)));
    stream.read(bytes.data() + before, static_cast<std::ptrdiff_t>(bytes.size() - before));
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
  }
  return bytes;
}

/// The content of a saved state. Throws Error where the stream holds no undamaged one.
template <class Stream>
std::string read_content(Stream& stream) {
  constexpr std::size_t header =
      archive_magic.size() + sizeof(std::uint32_t) + sizeof(std::uint64_t);
  std::string bytes = read_bytes(stream, header);
  if (!bytes.starts_with(archive_magic.substr(0, std::min(bytes.size(), archive_magic.size()))) ||
      bytes.empty())
    throw Error(
        "body.load: the stream holds no state that body.save wrote; open the right file, as "
        "a binary one");
  auto const truncated = [] {
    throw Error("body.load: the stream ends before the state does; save it anew");
  };
  if (bytes.size() < header) truncated();
  std::uint32_t version = 0;
  std::uint64_t length = 0, sum = 0;
  std::memcpy(&version, bytes.data() + archive_magic.size(), sizeof version);
  std::memcpy(&length, bytes.data() + archive_magic.size() + sizeof version, sizeof length);
  if (version != archive_version)
    throw Error("body.load: the state is of version ", version,
                " of the format, and this is version ", archive_version,
                "; load it with the version of Pliant that saved it");
  bytes += read_bytes(stream, length);
  std::string const tail = read_bytes(stream, sizeof sum);
  if (bytes.size() - header < length || tail.size() < sizeof sum) truncated();
  std::memcpy(&sum, tail.data(), sizeof sum);
  if (sum != checksum(bytes))
    throw Error("body.load: the state is damaged: its checksum is wrong; load another copy");
  bytes.erase(0, header);
  return bytes;
}

}  // namespace detail

/// Writes a body's state: see Body::save.
template <class Stream, class Parts>
void save_state(Stream& stream, Parts const& parts) {
  using State = typename Parts::state_type;
  using M = typename Parts::mesh_type;
  std::string content;
  detail::ByteWriter const write(content);
  write.put(detail::signature_of(parts));
  State::for_each_member(detail::WriteMember<M>{write, parts.first}, parts.state);
  write.put(parts.layout.node_rows());
  write.put(parts.add_watched_term != nullptr);
  write.put(parts.has_checkpoint);
  if (parts.has_checkpoint)
    State::for_each_member(detail::WriteMember<M>{write, parts.state.topology}, *parts.checkpoint);

  std::string bytes(detail::archive_magic);
  detail::ByteWriter const put(bytes);
  put.put(detail::archive_version);
  put.put(content);  // behind its length
  put.put(checksum(bytes));
  stream.write(bytes.data(), static_cast<std::ptrdiff_t>(bytes.size()));
  if (!stream) throw Error("body.save: the stream did not take the state; see that there is room");
}

/// Reads a body's state: see Body::load.
template <class Stream, class Parts>
void load_state(Stream& stream, Parts& parts) {
  using State = typename Parts::state_type;
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  constexpr int dim = Parts::dim;
  std::string const content = detail::read_content(stream);
  std::string_view rest = content;
  detail::ByteReader<B> const read(parts.backend, rest);
  detail::Signature signature;
  read.get(signature);
  detail::check_signature(signature, detail::signature_of(parts));
  State state;
  std::optional<State> checkpoint;
  bool watched = false, has_checkpoint = false;
  NodeRows node_rows;
  State::for_each_member(detail::ReadMember<B, M>{read, parts.first}, state);
  read.get(node_rows);
  read.get(watched);
  read.get(has_checkpoint);
  if (has_checkpoint)
    State::for_each_member(detail::ReadMember<B, M>{read, state.topology}, checkpoint.emplace());
  read.finish();
  detail::check_rows(node_rows, state.topology->nodes());
  typename Parts::layout_type layout(parts.backend, *state.topology, parts.material, parts.groups,
                                     &parts.layout, std::move(node_rows));
  auto const complete = [&](State& s) {
    detail::check_sizes(s, layout);
    s.prescribed = detail::with_motions<dim>(*s.prescribed, parts.motions);
  };
  complete(state);
  if (checkpoint) complete(*checkpoint);

  Parts next = parts_on(parts, std::move(layout), state.topology, state.prescribed);
  if (!state.prescribed->pressures.empty())
    next.upload_pressures = [](Parts& p) { upload_pressures(p); };
  if (state.rest.size() > 0) let_sleep(next);
  copy_state(next.backend, state, next.state);
  follow_state(next);
  put_in_force(parts, std::move(next));
  parts.checkpoint = std::move(checkpoint);
  parts.has_checkpoint = has_checkpoint;
  parts.add_watched_term = nullptr;
  if (watched) parts.add_watched_term = add_acceleration_term<Parts>;
  parts.integrator = nullptr;
}

}  // namespace pliant

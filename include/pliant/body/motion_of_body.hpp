#pragma once

#include <pliant/body/body.hpp>

// Members of Body: forces, steps, checkpoints, another mesh.
namespace pliant {

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::accumulate_forces(ConstField u, Field f) const {
  for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    table.with_geometry([&](auto geometry) {
      backend_.template accumulate<Table::groups>(
          table.elements, ForceKernel<typename Table::Laws, geometry.value>{table.laws}, f,
          rest_field(), u);
    });
  });
  surface_forces_.add(backend_, rest_field(), u, f);
  layout_.slaves.hand_to_masters(backend_, f);
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::forget_forces() {
  if (!forces_current_) return;
  clear(Field{layout_.f.data()}, nodes());
  forces_current_ = false;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::evaluate_forces() {
  if (forces_current_) return;
  accumulate_forces(std::as_const(*this).displacement_field(), Field{layout_.f.data()});
  forces_current_ = true;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::advance(double lag, double kick, double drift) {
  Field const u = displacement_field(), v{layout_.v.data()};
  backend_.for_each(nodes(), Advance<T, dim>{u,
                                             v,
                                             {layout_.f.data()},
                                             layout_.mass.data(),
                                             layout_.held.data(),
                                             external_forces(),
                                             static_cast<T>(lag),
                                             static_cast<T>(kick),
                                             static_cast<T>(drift)});
  layout_.slaves.interpolate(backend_, v);
  if (drift != 0) {
    layout_.slaves.interpolate(backend_, u);
    forces_current_ = false;
  }
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_step_size(double step) {
  if (!has_internal_variables || step == step_size_) return;
  step_size_ = step;
  for_each_table([&](auto& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    auto const prepare = [&]<class F>(F const*, auto& law) {
      if constexpr (internal_variables_of<F> > 0) law = prepared<F>(law_cast<T>(law_of<F>()), step);
    };
    [&]<int... G>(std::integer_sequence<int, G...>) {
      (prepare(static_cast<typename Table::template formulation<G> const*>(nullptr),
               std::get<G>(table.laws.laws)),
       ...);
    }(std::make_integer_sequence<int, Table::groups>());
  });
  forget_forces();
  ++revision_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::commit() {
  for_each_table([&](auto& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if constexpr (Table::Laws::internal_variable_count > 0)
      backend_.template visit<Table::groups>(
          table.elements, CommitVisitor<T, typename Table::Laws>{table.laws}, table.no_counters,
          rest_field(), std::as_const(*this).displacement_field());
  });
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::equilibrate() {
  synchronize_velocities();
  for_each_table([&](auto& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if constexpr (Table::Laws::internal_variable_count > 0)
      backend_.template visit<Table::groups>(
          table.elements, CarryInternalVariables<T, typename Table::Laws>{table.laws, nullptr},
          table.no_counters, rest_field(), std::as_const(*this).displacement_field());
  });
  checkpoint_.reset();
  forget_forces();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::synchronize_velocities() {
  if (owed_ == 0) return;
  evaluate_forces();
  advance(owed_, 0, 0);
  owed_ = 0;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::replace(layout_type layout, std::vector<Condition<dim>> conditions,
                                std::vector<Pressure<dim>> pressures, std::vector<Point<dim>> loads,
                                std::shared_ptr<Hierarchy const> tree,
                                std::vector<typename History<dim>::Totals> totals) {
  layout_ = std::move(layout);
  history_.tree = std::move(tree);
  history_.totals = std::move(totals);
  history_.born = steps_;
  conditions_ = std::move(conditions);
  pressures_ = std::move(pressures);
  loads_ = std::move(loads);
  if (!loads_.empty()) upload_loads();
  upload_conditions();
  if (press_again_) press_again_(*this);
  scratch_.reset();
  checkpoint_.reset();
  recorded_.reset();
  owed_ = 0;
  forces_current_ = false;                        // those of the new layout are zero
  set_step_size(std::exchange(step_size_, 0.0));  // and its laws new
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::step(double dt, int steps) {
  // Steps that are not like the others.
  auto const special = [&] {
    return owed_ != dt / 2 || has_motions() || forces_current_ ||
           (has_internal_variables && step_size_ != dt);
  };
  for (; steps > 0 && special(); --steps) {
    evaluate_forces();
    commit();
    advance(owed_, dt / 2, dt);
    set_step_size(dt);
    owed_ = dt / 2;
    time_ += dt;
    ++steps_;
    prescribe(time_, dt);
  }
  if (steps == 0) return;
  if (!recorded_ || recorded_->body != this || recorded_->dt != dt ||
      recorded_->revision != revision_)
    recorded_ = RecordedStep{backend_.record([this, dt] {
                               accumulate_forces(std::as_const(*this).displacement_field(),
                                                 Field{layout_.f.data()});
                               commit();
                               advance(dt / 2, dt / 2, dt);
                             }),
                             this, dt, revision_};
  recorded_->recording.replay(steps);
  time_ += steps * dt;
  steps_ += steps;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::checkpoint() {
  synchronize_velocities();
  if (!checkpoint_) {
    using A = typename B::template Array<T>;
    checkpoint_ = Checkpoint{A(layout_.u.size()), A(layout_.v.size()), {}, 0, 0, 0};
    for_each_table([&](auto const& table) {
      if (table.internal_variables.size() > 0)
        checkpoint_->internal_variables.emplace_back(table.internal_variables.size());
    });
  }
  auto const count = static_cast<Index>(layout_.u.size());
  backend_.for_each(count, Copy<T>{layout_.u.data(), checkpoint_->u.data()});
  backend_.for_each(count, Copy<T>{layout_.v.data(), checkpoint_->v.data()});
  std::size_t which = 0;
  for_each_table([&](auto& table) {
    if (table.internal_variables.size() > 0)
      backend_.for_each(static_cast<Index>(table.internal_variables.size()),
                        Copy<T>{table.internal_variables.data(),
                                checkpoint_->internal_variables[which++].data()});
  });
  checkpoint_->time = time_;
  checkpoint_->step_size = step_size_;
  checkpoint_->steps = steps_;
}

template <Backend B, class M, class... Fs>
bool Body<B, M, Fs...>::restore() {
  if (!checkpoint_) return false;
  auto const count = static_cast<Index>(layout_.u.size());
  backend_.for_each(count, Copy<T>{checkpoint_->u.data(), layout_.u.data()});
  backend_.for_each(count, Copy<T>{checkpoint_->v.data(), layout_.v.data()});
  std::size_t which = 0;
  for_each_table([&](auto& table) {
    if (table.internal_variables.size() > 0)
      backend_.for_each(static_cast<Index>(table.internal_variables.size()),
                        Copy<T>{checkpoint_->internal_variables[which++].data(),
                                table.internal_variables.data()});
  });
  set_step_size(checkpoint_->step_size);
  time_ = checkpoint_->time;
  steps_ = checkpoint_->steps;
  owed_ = 0;
  forget_forces();
  return true;
}

}  // namespace pliant

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
void Body<B, M, Fs...>::synchronize_velocities() {
  if (owed_ == 0) return;
  evaluate_forces();
  advance(owed_, 0, 0);
  owed_ = 0;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::replace(layout_type layout, std::vector<Condition<dim>> conditions,
                                std::vector<Point<dim>> loads,
                                std::shared_ptr<Hierarchy const> tree,
                                std::vector<typename History<dim>::Totals> totals) {
  layout_ = std::move(layout);
  history_.tree = std::move(tree);
  history_.totals = std::move(totals);
  history_.born = steps_;
  conditions_ = std::move(conditions);
  loads_ = std::move(loads);
  if (!loads_.empty()) upload_loads();
  upload_conditions();
  scratch_.reset();
  checkpoint_.reset();
  recorded_.reset();
  owed_ = 0;
  forces_current_ = false;  // those of the new layout are zero
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::step(double dt, int steps) {
  // Steps that are not like the others.
  for (; steps > 0 && (owed_ != dt / 2 || has_motions() || forces_current_); --steps) {
    evaluate_forces();
    advance(owed_, dt / 2, dt);
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
    checkpoint_ = Checkpoint{A(layout_.u.size()), A(layout_.v.size()), 0, 0};
  }
  auto const count = static_cast<Index>(layout_.u.size());
  backend_.for_each(count, Copy<T>{layout_.u.data(), checkpoint_->u.data()});
  backend_.for_each(count, Copy<T>{layout_.v.data(), checkpoint_->v.data()});
  checkpoint_->time = time_;
  checkpoint_->steps = steps_;
}

template <Backend B, class M, class... Fs>
bool Body<B, M, Fs...>::restore() {
  if (!checkpoint_) return false;
  auto const count = static_cast<Index>(layout_.u.size());
  backend_.for_each(count, Copy<T>{checkpoint_->u.data(), layout_.u.data()});
  backend_.for_each(count, Copy<T>{checkpoint_->v.data(), layout_.v.data()});
  time_ = checkpoint_->time;
  steps_ = checkpoint_->steps;
  owed_ = 0;
  forget_forces();
  return true;
}

}  // namespace pliant

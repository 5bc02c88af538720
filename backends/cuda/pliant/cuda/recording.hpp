#pragma once

#include <functional>
#include <memory>

#include <pliant/cuda/context.hpp>

namespace pliant {

/// Verbs recorded as a CUDA graph: each replay is one launch, however many verbs it holds.
class CudaRecording {
 public:
  CudaRecording() = default;
  /// Records what f launches; runs none of it.
  CudaRecording(std::shared_ptr<detail::CudaContext const> context, std::function<void()> const& f)
      : context_(std::move(context)) {
    auto const& stream = context_->stream();
    auto const device = stream->enter();
    // Other threads may call CUDA while this one records.
    detail::check(cudaStreamBeginCapture(stream->get(), cudaStreamCaptureModeThreadLocal),
                  "cudaStreamBeginCapture");
    cudaGraph_t graph = nullptr;
    try {
      f();
    } catch (...) {
      cudaStreamEndCapture(stream->get(), &graph);
      if (graph != nullptr) cudaGraphDestroy(graph);
      cudaGetLastError();
      throw;
    }
    detail::check(cudaStreamEndCapture(stream->get(), &graph), "cudaStreamEndCapture");
    cudaGraphExec_t executable = nullptr;
    cudaError_t const status = cudaGraphInstantiate(&executable, graph, 0);
    cudaGraphDestroy(graph);
    detail::check(status, "cudaGraphInstantiate");
    graph_.reset(executable, [](cudaGraphExec_t g) { cudaGraphExecDestroy(g); });
  }

  void replay(int n) const {
    if (!graph_) throw Error("CUDA: replay of an empty recording; make it with record");
    auto const& stream = context_->stream();
    auto const device = stream->enter();
    for (int k = 0; k < n; ++k)
      detail::check(cudaGraphLaunch(graph_.get(), stream->get()), "cudaGraphLaunch");
  }

 private:
  std::shared_ptr<detail::CudaContext const> context_;  // whose memory the verbs use
  std::shared_ptr<CUgraphExec_st> graph_;
};

}  // namespace pliant

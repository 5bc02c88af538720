#pragma once

#include <functional>
#include <memory>

#include <pliant/cuda/context.hpp>

namespace pliant {

/// Verbs recorded as a CUDA graph.
class CudaRecording {
 public:
  CudaRecording() = default;
  /// Records what f launches; runs none of it.
  CudaRecording(std::shared_ptr<detail::CudaContext> context, std::function<void()> const& f)
      : context_(std::move(context)) {
    context_->make_current();
    // Other threads may call CUDA while this one records.
    detail::check(cudaStreamBeginCapture(context_->stream(), cudaStreamCaptureModeThreadLocal),
                  "cudaStreamBeginCapture");
    cudaGraph_t graph = nullptr;
    try {
      f();
    } catch (...) {
      cudaStreamEndCapture(context_->stream(), &graph);
      if (graph != nullptr) cudaGraphDestroy(graph);
      cudaGetLastError();
      throw;
    }
    detail::check(cudaStreamEndCapture(context_->stream(), &graph), "cudaStreamEndCapture");
    cudaGraphExec_t executable = nullptr;
    cudaError_t const status = cudaGraphInstantiate(&executable, graph, 0);
    cudaGraphDestroy(graph);
    detail::check(status, "cudaGraphInstantiate");
    graph_.reset(executable, [](cudaGraphExec_t g) { cudaGraphExecDestroy(g); });
  }

  void replay(int n) const {
    if (!graph_) throw Error("CUDA: replay of an empty recording; make it with record");
    context_->make_current();
    for (int k = 0; k < n; ++k)
      detail::check(cudaGraphLaunch(graph_.get(), context_->stream()), "cudaGraphLaunch");
  }

 private:
  std::shared_ptr<detail::CudaContext> context_;
  std::shared_ptr<CUgraphExec_st> graph_;
};

}  // namespace pliant

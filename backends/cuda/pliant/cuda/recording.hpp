#pragma once

#include <functional>
#include <memory>

#include <pliant/cuda/stream.hpp>

namespace pliant {

/// Verbs recorded as a CUDA graph: each replay is one launch, however many verbs it holds.
class CudaRecording {
 public:
  CudaRecording() = default;
  /// Records what f launches; runs none of it.
  CudaRecording(detail::SharedStream stream, std::function<void()> const& f)
      : stream_(std::move(stream)) {
    auto const device = stream_->enter();
    // Other threads may call CUDA while this one records.
    detail::check(cudaStreamBeginCapture(stream_->get(), cudaStreamCaptureModeThreadLocal),
                  "cudaStreamBeginCapture");
    cudaGraph_t graph = nullptr;
    try {
      f();
    } catch (...) {
      cudaStreamEndCapture(stream_->get(), &graph);
      if (graph != nullptr) cudaGraphDestroy(graph);
      cudaGetLastError();
      throw;
    }
    detail::check(cudaStreamEndCapture(stream_->get(), &graph), "cudaStreamEndCapture");
    cudaGraphExec_t executable = nullptr;
    cudaError_t const status = cudaGraphInstantiate(&executable, graph, 0);
    cudaGraphDestroy(graph);
    detail::check(status, "cudaGraphInstantiate");
    graph_.reset(executable, [](cudaGraphExec_t g) { cudaGraphExecDestroy(g); });
  }

  void replay(int n) const {
    if (!graph_) throw Error("CUDA: replay of an empty recording; make it with record");
    auto const device = stream_->enter();
    for (int k = 0; k < n; ++k)
      detail::check(cudaGraphLaunch(graph_.get(), stream_->get()), "cudaGraphLaunch");
  }

 private:
  detail::SharedStream stream_;
  std::shared_ptr<CUgraphExec_st> graph_;
};

}  // namespace pliant

#pragma once

#include <cstddef>

#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/stream.hpp>

#if CUDART_VERSION < 12040
#error "Pliant needs CUDA 12.4 or later, whose graphs have conditional nodes."
#endif

// A part of a recorded graph that a replay runs only where a number on the device says so.
namespace pliant::detail {

inline __global__ void set_condition(cudaGraphConditionalHandle handle, double const* flag) {
  cudaGraphSetConditional(handle, *flag != 0 ? 1u : 0u);
}

/// The graph that a stream is recording, and what the next node of it comes after.
struct OpenGraph {
  cudaGraph_t graph = nullptr;
  cudaGraphNode_t const* last = nullptr;
  cudaGraphEdgeData const* edges = nullptr;
  std::size_t count = 0;

  explicit OpenGraph(cudaStream_t stream) {
    cudaStreamCaptureStatus status{};
#if CUDART_VERSION < 13000
    check(cudaStreamGetCaptureInfo_v3(stream, &status, nullptr, &graph, &last, &edges, &count),
          "cudaStreamGetCaptureInfo");
#else
    check(cudaStreamGetCaptureInfo(stream, &status, nullptr, &graph, &last, &edges, &count),
          "cudaStreamGetCaptureInfo");
#endif
  }
  /// The stream goes on behind this node.
  cudaGraphNode_t add(cudaGraphNodeParams& parameters, cudaStream_t stream) const {
    cudaGraphNode_t node = nullptr;
#if CUDART_VERSION < 13000
    check(cudaGraphAddNode_v2(&node, graph, last, edges, count, &parameters), "cudaGraphAddNode");
    check(cudaStreamUpdateCaptureDependencies_v2(stream, &node, nullptr, 1,
                                                 cudaStreamSetCaptureDependencies),
          "cudaStreamUpdateCaptureDependencies");
#else
    check(cudaGraphAddNode(&node, graph, last, edges, count, &parameters), "cudaGraphAddNode");
    check(cudaStreamUpdateCaptureDependencies(stream, &node, nullptr, 1,
                                              cudaStreamSetCaptureDependencies),
          "cudaStreamUpdateCaptureDependencies");
#endif
    return node;
  }
};

/// While a stream records: records what f launches as a branch that a replay takes where *flag is not zero
/// then.
template <class F>
void record_branch(DeviceStream const& stream, double const* flag, F const& f) {
  auto const device = stream.enter();
  cudaStream_t const outer = stream.get();
  cudaGraphConditionalHandle handle{};
  check(cudaGraphConditionalHandleCreate(&handle, OpenGraph(outer).graph, 0,
                                         cudaGraphCondAssignDefault),
        "cudaGraphConditionalHandleCreate");
  launch("if_set", {1, 1}, outer, set_condition, handle, flag);
  cudaGraphNodeParams parameters{};
  parameters.type = cudaGraphNodeTypeConditional;
  parameters.conditional.handle = handle;
  parameters.conditional.type = cudaGraphCondTypeIf;
  parameters.conditional.size = 1;
  OpenGraph(outer).add(parameters, outer);

  cudaStream_t inner = nullptr;
  check(cudaStreamCreateWithFlags(&inner, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
  auto const end = [&] {
    cudaGraph_t body = nullptr;
    cudaError_t const status = cudaStreamEndCapture(inner, &body);
    cudaStreamDestroy(inner);
    return status;
  };
  try {
    check(cudaStreamBeginCaptureToGraph(inner, parameters.conditional.phGraph_out[0], nullptr,
                                        nullptr, 0, cudaStreamCaptureModeThreadLocal),
          "cudaStreamBeginCaptureToGraph");
    auto const queued = stream.queue_on(inner);
    f();
  } catch (...) {
    end();
    cudaGetLastError();
    throw;
  }
  check(end(), "cudaStreamEndCapture");
}

}  // namespace pliant::detail

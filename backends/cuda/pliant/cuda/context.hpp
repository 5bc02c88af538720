#pragma once

#include <pliant/cuda/array.hpp>
#include <pliant/cuda/pinned_array.hpp>
#include <pliant/cuda/scratch.hpp>
#include <pliant/cuda/side_stream.hpp>

namespace pliant::detail {

/// What all copies of one backend share: a stream, and room for reductions and lists.
class CudaContext {
 public:
  explicit CudaContext(CudaOptions const& options)
      : stream_(std::make_shared<DeviceStream const>(options)),
        partials_(stream_, max_partials),
        blocks_done_(stream_, 1),
        scratch_(stream_),
        result_(stream_, 1) {}
  CudaContext(CudaContext const&) = delete;
  CudaContext& operator=(CudaContext const&) = delete;

  static constexpr int max_partials = 1024;

  SharedStream const& stream() const { return stream_; }
  double* partials() { return partials_.data(); }
  /// Zero between reductions.
  unsigned* blocks_done() { return blocks_done_.data(); }
  DeviceScratch& scratch() { return scratch_; }
  /// Made when it is asked for first.
  std::shared_ptr<SideStream> const& side_stream() {
    if (!side_stream_) side_stream_ = std::make_shared<SideStream>(stream_);
    return side_stream_;
  }
  /// In host memory that kernels can write to.
  double* result() { return result_.data(); }

 private:
  SharedStream stream_;
  DeviceArray<double> partials_;
  DeviceArray<unsigned> blocks_done_;
  DeviceScratch scratch_;
  std::shared_ptr<SideStream> side_stream_;
  PinnedArray<double> result_;
};

}  // namespace pliant::detail

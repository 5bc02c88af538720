#pragma once

#include <pliant/cuda/array.hpp>
#include <pliant/cuda/pinned_array.hpp>
#include <pliant/cuda/scratch.hpp>
#include <pliant/cuda/side_stream.hpp>
#include <pliant/cuda/tuning.hpp>

namespace pliant::detail {

/// What blocks that scan a list tell each other: sums over its parts (scan.cuh). A number that is never the same for two launches, behind
/// which kinds are counted, tells sums from those of launches before.
struct PartSums {
  enum Kind : unsigned { of_part = 1, known, kinds };  // over a part; over all up to its end
  unsigned long long parts[most_list_blocks];          // the sum, and behind it number and kind
  unsigned started, ended, next_tag;                   // blocks, of the launch that runs
};

/// What all copies of one backend share: a stream, and room for reductions and lists.
class CudaContext {
 public:
  explicit CudaContext(CudaOptions const& options)
      : stream_(std::make_shared<DeviceStream const>(options)),
        partials_(stream_, max_partials),
        blocks_done_(stream_, 1),
        part_sums_(stream_, 1),
        scratch_(stream_),
        result_(stream_, 1) {}
  CudaContext(CudaContext const&) = delete;
  CudaContext& operator=(CudaContext const&) = delete;

  static constexpr int max_partials = 1024;

  SharedStream const& stream() const { return stream_; }
  double* partials() { return partials_.data(); }
  /// Zero between reductions.
  unsigned* blocks_done() { return blocks_done_.data(); }
  PartSums* part_sums() { return part_sums_.data(); }
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
  DeviceArray<PartSums> part_sums_;  // zero at first
  DeviceScratch scratch_;
  std::shared_ptr<SideStream> side_stream_;
  PinnedArray<double> result_;
};

}  // namespace pliant::detail

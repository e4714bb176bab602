// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cstddef>
#include <iterator>
#include <memory>
#include <vector>

#include "posefusion/map/surfels.hpp"

namespace pf {

/// The surfels that were made in one cube of a fragment. Fusion and corrections may move them
/// beyond its faces.
struct SurfelBlock {
  int fragment = kFirstFragment;
  SurfelArrays surfels;        ///< in the order in which they were made
  Eigen::AlignedBox3f bounds;  ///< holds all centres (m, map frame of the fragment)
  float largest_radius = 0;    ///< m
  bool any_unstable = false;   ///< false: all are stable
  int changed = -1;            ///< frame of the last change (or somewhat later): what to save

  /// That it holds, used or reserved (bytes).
  std::size_t memory() const {
    return sizeof(SurfelBlock) + surfels.x.capacity() * SurfelArrays::bytesPerSurfel();
  }
};

/// A list of blocks. Copies of the list share the blocks: whoever changes one that is shared gets a
/// copy of that one. A list has one thread that copies and changes it; its copies may be read,
/// changed and destroyed in others.
class SharedBlocks {
 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = SurfelBlock;
    using difference_type = std::ptrdiff_t;
    using pointer = const SurfelBlock*;
    using reference = const SurfelBlock&;

    explicit Iterator(const std::shared_ptr<SurfelBlock>* at = nullptr) : at_(at) {}
    reference operator*() const { return **at_; }
    pointer operator->() const { return at_->get(); }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(at_++); }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const std::shared_ptr<SurfelBlock>* at_;
  };

  std::size_t size() const { return blocks_.size(); }
  const SurfelBlock& operator[](std::size_t i) const { return *blocks_[i]; }
  Iterator begin() const { return Iterator(blocks_.data()); }
  Iterator end() const { return Iterator(blocks_.data() + blocks_.size()); }

  /// The block, to be changed. Different ones may be asked for by different threads.
  SurfelBlock& change(std::size_t i) {
    std::shared_ptr<SurfelBlock>& block = blocks_[i];
    if (block.use_count() > 1) block = copyOf(*block);
    // The last other owner, in another thread, has finished reading the block.
    std::atomic_thread_fence(std::memory_order_acquire);
    return *block;
  }

  /// A new, empty one, at the end.
  SurfelBlock& append() { return *blocks_.emplace_back(std::make_shared<SurfelBlock>()); }

  /// Whether neither list has changed block i since one was copied from the other.
  bool isShared(std::size_t i, const SharedBlocks& other) const {
    return i < size() && i < other.size() && blocks_[i] == other.blocks_[i];
  }

  /// The surfels of block i as they are now, for any thread and as long as they are held.
  std::shared_ptr<const SurfelArrays> share(std::size_t i) const {
    return {blocks_[i], &blocks_[i]->surfels};
  }

  /// Exchanges block i for that of another list.
  void swap(std::size_t i, SharedBlocks& other) { blocks_[i].swap(other.blocks_[i]); }

  /// Gives up a share of block i; an empty one takes its place.
  void drop(std::size_t i) { blocks_[i] = std::make_shared<SurfelBlock>(); }

  void clear() { blocks_.clear(); }

 private:
  /// With what it has reserved.
  static std::shared_ptr<SurfelBlock> copyOf(const SurfelBlock& block) {
    auto copy = std::make_shared<SurfelBlock>();
    copy->surfels.forEachArray(block.surfels, [&](auto& array, const auto& other) {
      array.reserve(other.capacity());
      array = other;
    });
    copy->fragment = block.fragment;
    copy->bounds = block.bounds;
    copy->largest_radius = block.largest_radius;
    copy->any_unstable = block.any_unstable;
    copy->changed = block.changed;
    return copy;
  }

  std::vector<std::shared_ptr<SurfelBlock>> blocks_;
};

}  // namespace pf

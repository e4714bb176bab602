// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/calibrated_source.hpp"

#include <utility>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

class CalibratedSource : public FrameSource {
 public:
  CalibratedSource(std::unique_ptr<FrameSource> source, const std::string& file)
      : source_(std::move(source)), frames_(file) {}

  std::size_t frameCount() const override { return source_->frameCount(); }
  RecordedPeople people() override { return source_->people(); }
  Trajectory truth() override { return source_->truth(); }
  std::string sensorKind() const override { return source_->sensorKind(); }
  InputReport report() const override { return source_->report(); }

  std::optional<SourceFrame> next() override {
    auto next = source_->next();
    if (!next || !next->defect.empty() || !defectOf(next->frame).empty()) return next;
    next->frame = frames_.correct(rectifier_.rectify(next->frame));
    return next;
  }

 private:
  std::unique_ptr<FrameSource> source_;
  Rectifier rectifier_;
  CalibratedFrames frames_;
};

}  // namespace

CalibratedFrames::CalibratedFrames(const std::string& file)
    : file_(file), calibration_(loadCalibration(file)), corrector_(calibration_.field) {}

RgbdFrame CalibratedFrames::correct(const RgbdFrame& straight) {
  const std::string wrong = misfit(calibration_, straight.camera);
  if (!wrong.empty()) throw InputError(file_ + ": " + wrong);
  return corrector_.correct(straight);
}

std::unique_ptr<FrameSource> calibrated(std::unique_ptr<FrameSource> source,
                                        const std::string& calibration_file) {
  if (calibration_file.empty()) return source;
  return std::make_unique<CalibratedSource>(std::move(source), calibration_file);
}

}  // namespace pf

// The last position stays: what a loop without prediction does.
#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

namespace {

class Hold final : public MotionPredictor {
 public:
  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !(sample.time_s > last_.time_s || !seen_)) return;
    last_ = sample;
    seen_ = true;
  }

  Prediction predict(double time_s) const override {
    Prediction p;
    p.valid = seen_;
    p.time_s = time_s;
    p.position = last_.position;
    p.covariance = last_.covariance;
    return p;
  }

 private:
  MotionSample last_;
  bool seen_ = false;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_hold(const PredictorOptions&) { return std::make_unique<Hold>(); }

}  // namespace heartservo::servo

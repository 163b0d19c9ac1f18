#include "servo/ecg/ecg_record.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {
namespace {

using test::message_of;

std::string in_212(const std::vector<int>& samples) {
  std::string bytes;
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    const int a = samples[i] & 0xFFF, b = (i + 1 < samples.size() ? samples[i + 1] : 0) & 0xFFF;
    for (const int byte : {a & 0xFF, (a >> 8) | ((b >> 8) << 4), b & 0xFF}) bytes.push_back(static_cast<char>(byte));
  }
  return bytes;
}
std::string in_16(const std::vector<int>& values) {
  std::string bytes;
  for (const int v : values)
    for (const int byte : {v & 0xFF, (v >> 8) & 0xFF}) bytes.push_back(static_cast<char>(byte));
  return bytes;
}

class Ecg : public testing::Test {
 protected:
  std::string refused(const std::string& path) const {
    return message_of<InputError>([&] { read_ecg(path); });
  }
  void expect_refused(const std::string& header, const std::string& part) const {
    const std::string message = refused(folder_.write("bad.hea", header));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(Ecg, Format212WithTwoSignalsAndNegativeValues) {
  folder_.write("r.dat", in_212({100, -1, -2047, 2047, 300, -2048}));
  const auto header = folder_.write(
      "r.hea", "# comment\nr 2 360 3\nr.dat 212 200(100)/mV 12 0 0 0 0 MLII\nr.dat 212 100 12 7 0 0 0 V5\n");
  const auto a = read_ecg(header), b = read_ecg(header, "V5");
  EXPECT_EQ(a.lead, "MLII");
  EXPECT_EQ(a.rate_hz, 360);
  EXPECT_EQ(a.value, (std::vector<double>{0, -2147 / 200.0, 1}));
  EXPECT_NEAR(b.value[0], (-1 - 7) / 100.0, 1e-12) << "the converter's zero is the baseline";
  EXPECT_NEAR(b.value[1], 20.4, 1e-12);
  EXPECT_TRUE(std::isnan(b.value[2])) << "-2048 marks a sample that is missing";
  EXPECT_EQ(read_ecg(folder_ / "r").value, a.value);
  EXPECT_EQ(read_ecg(folder_ / "r.dat").value, a.value);
}

TEST_F(Ecg, Format16WithOffsetSeveralSamplesPerFrameAndSkew) {
  // frames of two samples of the first signal and one of the second, which is written one frame late
  folder_.write("m.dat", "ab" + in_16({1, 2, 30, 3, 4, 31, 5, -32768, 32}));
  const auto header =
      folder_.write("m.hea", "m 2 125 3\nm.dat 16x2+2 1 16 0 0 0 0 ABP\nm.dat 16:1+2 1 16 0 0 0 0 MCL1\n");
  const auto first = read_ecg(header, "ABP"), ecg = read_ecg(header);
  EXPECT_EQ(first.rate_hz, 250);
  EXPECT_EQ(std::vector<double>(first.value.begin(), first.value.begin() + 5), (std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_TRUE(std::isnan(first.value[5]));
  EXPECT_EQ(ecg.lead, "MCL1") << "the first that is an ECG";
  EXPECT_EQ(ecg.value[0], 31);
  EXPECT_EQ(ecg.value[1], 32);
  EXPECT_TRUE(std::isnan(ecg.value[2]));
}

TEST_F(Ecg, Annotations) {
  // a beat (1) after 100 samples, a rhythm mark (28) with text, a long jump, a ventricular beat (5), the end
  std::string bytes = in_16({1 << 10 | 100, 28 << 10 | 5, 63 << 10 | 3});
  bytes += std::string("(N\0\0", 4);
  bytes += in_16({59 << 10, 1, 464, 5 << 10 | 31, 0});
  const auto file = folder_.write("r.atr", bytes);
  EXPECT_EQ(read_annotated_beats(file, 100), (std::vector<double>{1, (105 + 65536 + 464 + 31) / 100.0}));
  const auto cut = folder_.write("cut.atr", bytes.substr(0, 6));
  EXPECT_NE(message_of<InputError>([&] { read_annotated_beats(cut, 100); }).find("cut.atr: ends within"),
            std::string::npos);
  const auto samples = folder_.write("b.csv", ",R\n0,36\n1,360\n"),
             seconds = folder_.write("c.csv", "time_s\n0.1\n1\n");
  EXPECT_EQ(read_annotated_beats(samples, 360), (std::vector<double>{0.1, 1}));
  EXPECT_EQ(read_annotated_beats(seconds, 360), (std::vector<double>{0.1, 1}));
  const auto back = folder_.write("d.csv", "time_s\n1\n0.1\n");
  EXPECT_NE(message_of<InputError>([&] { read_annotated_beats(back, 1); }).find("d.csv:3: beat at 0.1 s after 1 s"),
            std::string::npos);
}

TEST_F(Ecg, Csv) {
  const auto file = folder_.write("e.csv", "time_s,ecg_mv,other\n1,0.5,9\n1.01,,9\n1.02,0.7,9\n");
  const auto record = read_ecg(file);
  EXPECT_EQ(record.lead, "ecg_mv");
  EXPECT_NEAR(record.rate_hz, 100, 1e-9);
  EXPECT_EQ(record.start_s, 1);
  EXPECT_TRUE(std::isnan(record.value[1]));
  EXPECT_EQ(read_ecg(file, "other").value[0], 9);
  EXPECT_NE(message_of<ConfigError>([&] { read_ecg(file, "ecg_mV"); }).find("did you mean 'ecg_mv'"),
            std::string::npos);
  const auto says = [&](const std::string& text) { return refused(folder_.write("bad.csv", text)); };
  EXPECT_NE(says("").find("bad.csv:1: is empty"), std::string::npos);
  EXPECT_NE(says("t,ecg\n").find("bad.csv:1: expected a header with time_s"), std::string::npos);
  EXPECT_NE(says("time_s,ecg\n0,1\n").find("1 row"), std::string::npos);
  EXPECT_NE(says("time_s,ecg\n0,1\n0.01,x\n").find("bad.csv:3: 'x' under ecg"), std::string::npos);
  EXPECT_NE(says("time_s,ecg\n0.01,1\n0,1\n").find("bad.csv:3: time 0 s after 0.01 s"), std::string::npos);
  EXPECT_NE(says("time_s,ecg\n0,1\n0.01,1\n0.02,2\n0.06,2\n0.07,2\n").find("not even in time"), std::string::npos);
  EXPECT_NE(says("time_s,ecg\n0,1\n0.1,1\n0.2,2\n").find("10 samples a second"), std::string::npos);
}

TEST_F(Ecg, BadHeadersAreRefusedByLine) {
  EXPECT_NE(refused(folder_ / "none.hea").find("cannot be read"), std::string::npos);
  EXPECT_NE(refused(folder_ / "none").find("no such ECG"), std::string::npos);
  expect_refused("", "bad.hea:1: is empty");
  expect_refused("r\n", "bad.hea:1: expected 'NAME SIGNALS RATE SAMPLES'");
  expect_refused("r/3 2 360\n", "several segments");
  expect_refused("r 1 zero\n", "'zero' is not a sampling rate");
  expect_refused("r 2 360\nr.dat 212\n", "2 signals are announced, 1 described");
  expect_refused("r 1 360\nr.dat 80\n", "bad.hea:2: signal format 80 is not supported");
  expect_refused("r 1 360\nr.dat 212y\n", "bad.hea:2: '212y' is not a signal format");
  expect_refused("r 1 360\nr.dat 212 1(x)\n", "'1(x)' is not a gain");
  expect_refused("r 1 360 10\nr.dat 212\n", "r.dat: cannot be read");
  folder_.write("r.dat", in_212({1, 2, 3, 4}));
  expect_refused("r 1 360 10\nr.dat 212\n", "r.dat: ends after 4 of 10 samples");
}

TEST_F(Ecg, ARecordOfSeveralKindsOfSignals) {
  const auto file = test::data("ecg/03700181.hea");
  SKIP_WITHOUT_DATA(file);
  const auto ecg = read_ecg(file.string()), breath = read_ecg(file.string(), "RESP");
  EXPECT_EQ(ecg.lead, "MCL1");
  EXPECT_EQ(ecg.rate_hz, 500);
  EXPECT_EQ(ecg.value.size(), 300000U);
  EXPECT_EQ(breath.rate_hz, 125);
  EXPECT_TRUE(std::isnan(breath.value.back())) << "written four frames late";
  const auto minute = read_ecg(test::data("ecg/a103l.hea").string());
  EXPECT_EQ(minute.value.size(), 82500U);
  EXPECT_NEAR(minute.value[0], -171 / 7247.0, 1e-9) << "the header's first value";
}

}  // namespace
}  // namespace heartservo::servo

#pragma once
// What a client of the OpenIGTLink library gets.
#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlTransformMessage.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>

namespace heartservo::test {

/// One message; without a name nothing came.
struct Received {
  std::string name;
  Eigen::Matrix4d pose = Eigen::Matrix4d::Zero();
  cv::Mat grey;
  double time_s = 0;
};

inline Received receive(igtl::ClientSocket& socket) {
  Received r;
  auto header = igtl::MessageHeader::New();
  header->InitPack();
  if (socket.Receive(header->GetPackPointer(), static_cast<int>(header->GetPackSize())) !=
      static_cast<int>(header->GetPackSize()))
    return r;
  header->Unpack();
  auto stamp = igtl::TimeStamp::New();
  header->GetTimeStamp(stamp);
  r.time_s = stamp->GetTimeStamp();
  const std::string type = header->GetDeviceType();
  if (type == "TRANSFORM") {
    auto message = igtl::TransformMessage::New();
    message->SetMessageHeader(header);
    message->AllocatePack();
    socket.Receive(message->GetPackBodyPointer(), static_cast<int>(message->GetPackBodySize()));
    EXPECT_TRUE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) << "checksum";
    igtl::Matrix4x4 m;
    message->GetMatrix(m);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) r.pose(i, j) = static_cast<double>(m[i][j]);
  } else if (type == "IMAGE") {
    auto message = igtl::ImageMessage::New();
    message->SetMessageHeader(header);
    message->AllocatePack();
    socket.Receive(message->GetPackBodyPointer(), static_cast<int>(message->GetPackBodySize()));
    EXPECT_TRUE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) << "checksum";
    int w = 0, h = 0, d = 0;
    message->GetDimensions(w, h, d);
    cv::Mat(h, w, CV_8UC1, message->GetScalarPointer()).copyTo(r.grey);
  }
  r.name = header->GetDeviceName();
  return r;
}

}  // namespace heartservo::test

#include "tools/igtl/igtl_stream.hpp"

#include <fmt/format.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlServerSocket.h>
#include <igtlTransformMessage.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

constexpr int kPatience_ms = 100;  // for a client to take one message
constexpr double kPictureEvery_s = 0.04;
constexpr std::size_t kMostClients = 8;

igtl::TimeStamp::Pointer stamp_of(double time_s) {
  auto stamp = igtl::TimeStamp::New();
  stamp->SetTime(time_s);
  return stamp;
}

igtl::TransformMessage::Pointer message_of(const char* name, const Eigen::Isometry3d& T, double time_s) {
  auto message = igtl::TransformMessage::New();
  message->SetDeviceName(name);
  auto stamp = stamp_of(time_s);
  message->SetTimeStamp(stamp);
  igtl::Matrix4x4 m;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) m[i][j] = static_cast<float>(T.matrix()(i, j) * (i < 3 && j == 3 ? 1e3 : 1));
  message->SetMatrix(m);
  message->Pack();
  return message;
}

igtl::ImageMessage::Pointer message_of(const cv::Mat& grey, double time_s) {
  auto message = igtl::ImageMessage::New();
  message->SetDeviceName("endoscope");
  auto stamp = stamp_of(time_s);
  message->SetTimeStamp(stamp);
  message->SetDimensions(grey.cols, grey.rows, 1);
  message->SetSpacing(1, 1, 1);
  message->SetScalarTypeToUint8();
  message->AllocateScalars();
  auto* to = static_cast<std::uint8_t*>(message->GetScalarPointer());
  for (int v = 0; v < grey.rows; ++v)
    std::memcpy(to + static_cast<std::ptrdiff_t>(v) * grey.cols, grey.ptr(v), static_cast<std::size_t>(grey.cols));
  message->Pack();
  return message;
}

}  // namespace

struct IgtlStream::Parts {
  igtl::ServerSocket::Pointer server = igtl::ServerSocket::New();
  std::vector<igtl::ClientSocket::Pointer> clients;  // of the thread alone
  mutable std::mutex mutex;
  std::condition_variable news;
  IgtlSnapshot latest;
  bool fresh = false, ends = false;
  Counts counts;
  std::thread thread;
  double last_picture_s = -1e9;

  void accept() {
    if (auto client = server->WaitForConnection(1); client.IsNotNull()) {
      if (clients.size() >= kMostClients) {
        client->CloseSocket();
        return;
      }
      client->SetSendTimeout(kPatience_ms);
      clients.push_back(client);
      last_picture_s = -1e9;  // it gets a picture with the next snapshot
    }
  }

  template <class Message>
  void send(Message& message) {
    const auto lost = std::remove_if(clients.begin(), clients.end(), [&](igtl::ClientSocket::Pointer& client) {
      if (client->GetConnected() && client->Send(message->GetPackPointer(), static_cast<int>(message->GetPackSize())))
        return false;
      client->CloseSocket();
      return true;
    });
    const std::lock_guard lock(mutex);
    counts.dropped_clients += static_cast<int>(clients.end() - lost);
    clients.erase(lost, clients.end());
    counts.clients = static_cast<int>(clients.size());
  }

  void run() {
    sigset_t pipe;  // a client that has gone is an answer, no signal
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
    IgtlSnapshot now;
    for (;;) {
      accept();
      {
        std::unique_lock lock(mutex);
        counts.clients = static_cast<int>(clients.size());
        news.wait_for(lock, std::chrono::milliseconds(20), [&] { return fresh || ends; });
        if (!fresh && ends) return;
        if (!fresh) continue;
        std::swap(now, latest);
        fresh = false;
        if (!clients.empty()) ++counts.sent;
      }
      if (clients.empty()) continue;
      if (now.has_target) {
        auto target = message_of("target", now.T_camera_target, now.time_s);
        send(target);
      }
      if (now.has_tip) {
        auto tip = message_of("tip", now.T_camera_tip, now.time_s);
        send(tip);
      }
      if (now.grey.empty() || now.time_s - last_picture_s < kPictureEvery_s) continue;
      last_picture_s = now.time_s;
      auto picture = message_of(now.grey, now.time_s);
      send(picture);
    }
  }
};

IgtlStream::IgtlStream(int port) : parts_(std::make_unique<Parts>()) {
  if (parts_->server->CreateServer(port) < 0)
    throw DeviceError(
        fmt::format("--igtl {}: the port cannot be had; is another program using it? choose another", port));
  parts_->thread = std::thread([this] { parts_->run(); });
}

IgtlStream::~IgtlStream() {
  {
    const std::lock_guard lock(parts_->mutex);
    parts_->ends = true;
  }
  parts_->news.notify_all();
  parts_->thread.join();
  for (auto& client : parts_->clients) client->CloseSocket();
  parts_->server->CloseSocket();
}

void IgtlStream::publish(const IgtlSnapshot& snapshot) {
  {
    const std::lock_guard lock(parts_->mutex);  // held elsewhere for some pointers' time only
    Parts& p = *parts_;
    p.latest.time_s = snapshot.time_s;
    p.latest.has_target = snapshot.has_target;
    p.latest.has_tip = snapshot.has_tip;
    p.latest.T_camera_target = snapshot.T_camera_target;
    p.latest.T_camera_tip = snapshot.T_camera_tip;
    if (snapshot.grey.empty())
      p.latest.grey.release();
    else
      snapshot.grey.copyTo(p.latest.grey);
    p.fresh = true;
    ++p.counts.published;
  }
  parts_->news.notify_one();
}

IgtlStream::Counts IgtlStream::counts() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->counts;
}

}  // namespace heartservo::tools

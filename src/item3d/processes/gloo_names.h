// Declarations of Gloo that c10d's ProcessGroupGloo.hpp mentions. LibTorch contains Gloo's code but
// not its headers. These declarations suffice to compile ProcessGroupGloo.hpp (src/CMakeLists.txt
// adds their include path). item3d calls none of them: all work goes through c10d's own functions.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace gloo {

class Context {
  public:
    void setTimeout(std::chrono::milliseconds timeout);
};

namespace rendezvous {

class Store {
  public:
    virtual ~Store();
    virtual void set(const std::string& key, const std::vector<char>& data) = 0;
    virtual std::vector<char> get(const std::string& key) = 0;
    virtual void wait(const std::vector<std::string>& keys) = 0;
    virtual void wait(const std::vector<std::string>& keys,
                      const std::chrono::milliseconds& timeout) = 0;
};

}  // namespace rendezvous

namespace transport {

class Device;

class UnboundBuffer {
  public:
    virtual ~UnboundBuffer();
};

}  // namespace transport
}  // namespace gloo

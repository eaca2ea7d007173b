// The studio on a socket.
#pragma once

#include "item3d/studio/studio.h"

#include <memory>
#include <string>

namespace item3d {

struct StudioRoutes;  // http.h

/// All that the studio's server answers, within which bounds.
void add_studio_routes(StudioRoutes& routes);

/// Answers requests in threads of its own, from the constructor to the destructor.
class StudioServer {
  public:
    /// studio outlives it. port 0: a free one. Throws as HttpListener.
    StudioServer(Studio& studio, const std::string& host, int port);
    ~StudioServer();
    StudioServer(const StudioServer&) = delete;
    StudioServer& operator=(const StudioServer&) = delete;

    int port() const;

  private:
    struct Sockets;
    std::unique_ptr<Sockets> sockets_;
};

}  // namespace item3d

#include "item3d/studio/http.h"
#include "item3d/studio/server.h"
#include "tests/fuzz/http_request.h"

#include <optional>

namespace {

/// A studio with one project. The programs that it would start do not exist.
struct FuzzedStudio {
    item3d::Studio studio;
    item3d::fuzz::OpenServer server;
    item3d::StudioRoutes routes{server, studio};

    FuzzedStudio() : studio(options()) {
        studio.store().set_model(studio.store().add_project("mug"), "mug.glb",
                                 {{"materials", {{{"index", 0}, {"name", "glaze"}}}}});
        studio.events().close();
        add_studio_routes(routes);
    }
    static item3d::StudioOptions options() {
        const auto settings = item3d::fuzz::as_file("settings.json", R"([
            {"name": "from", "flag": "--from", "type": "text"},
            {"name": "keep", "flag": "--keep", "type": "texts"},
            {"name": "seed", "flag": "--seed", "type": "integer"}])");
        const auto page = item3d::fuzz::as_file("index.html", "<p>page</p>").parent_path();
        std::filesystem::remove_all(page / "studio");
        return {page / "studio", page, page, page / "programs", {"secret", "", "cookie", ""}};
    }
};

}  // namespace

/// Answers a request, which gets the page's own host and token if it names none. Images of lights
/// take long and have the target light_request, so few of them are answered.
ITEM3D_FUZZ_TARGET(studio_request, data, size) {
    using namespace item3d;
    // Each 200 requests get a new studio, because requests add results and remove the project.
    static std::optional<FuzzedStudio> fuzzed;
    if (static int requests = 0; requests++ % 200 == 0) fuzzed.emplace();
    if (fuzz::as_text(data, size).starts_with("GET /api/lights/") && size % 32 != 0) return 0;
    return fuzz::read_or_refuse([&] {
        fuzzed->server.answer(fuzz::as_text(data, size), [](httplib::Request& request) {
            for (const auto& [name, value] :
                 {std::pair{"Host", "localhost"}, {"X-Item3d-Token", "secret"}})
                if (!request.has_header(name)) request.set_header(name, value);
        });
    });
}

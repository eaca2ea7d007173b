#include "item3d/studio/upload_routes.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/serve/secret.h"
#include "item3d/studio/bounded_file.h"
#include "item3d/studio/model_upload.h"
#include "item3d/studio/photograph_upload.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t megabyte = 1 << 20;
constexpr std::size_t longest_model = 512 * megabyte;
constexpr std::size_t longest_image = 64 * megabyte;
constexpr std::size_t longest_photographs = 1536 * megabyte;

/// File or folder in incoming/, which is removed on destruction.
class Incoming {
  public:
    explicit Incoming(fs::path path) : path_(std::move(path)) {}
    ~Incoming() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Incoming(const Incoming&) = delete;
    Incoming& operator=(const Incoming&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

/// Reads an upload. An exception of the callback is rethrown only after the reader has ended,
/// because the reader is not exception-safe.
template <typename Write>
void read_upload(const httplib::ContentReader& reader, Write write) {
    std::exception_ptr problem;
    const bool whole = reader([&](const char* data, std::size_t size) {
        try {
            write(data, size);
            return true;
        } catch (...) {
            problem = std::current_exception();
            return false;
        }
    });
    if (problem) std::rethrow_exception(problem);
    if (!whole) throw InputError("upload", "is incomplete", "upload it again");
}

void save_upload(const httplib::ContentReader& reader, const fs::path& path, std::size_t longest) {
    BoundedFile file(path, longest);
    read_upload(reader, [&](const char* data, std::size_t size) { file.add(data, size); });
    file.close();
}

/// Reads the files of a form. begin, add: functions that receive each file's field and name, and
/// its data. Rethrows like read_upload().
template <typename Begin, typename Add>
void read_form(const httplib::ContentReader& reader, Begin begin, Add add) {
    std::exception_ptr problem;
    const auto guarded = [&](const auto& step) {
        try {
            step();
            return true;
        } catch (...) {
            problem = std::current_exception();
            return false;
        }
    };
    const bool whole = reader(
        [&](const httplib::MultipartFormData& part) {
            return guarded([&] { begin(part.name, part.filename); });
        },
        [&](const char* data, std::size_t size) { return guarded([&] { add(data, size); }); });
    if (problem) std::rethrow_exception(problem);
    if (!whole) throw InputError("upload", "is incomplete", "upload it again");
}

std::string name_of(const HttpRequest& request) {
    const std::string name = request.get_param_value("name");
    if (name.empty()) throw InputError("name", "the file name is missing");
    return name;
}

void answer_model(Studio& studio, const HttpRequest& request, HttpResponse& response,
                  const httplib::ContentReader& reader) {
    if (request.has_param("demo")) {
        reply_json(response, project_json(studio.open_again(demo_model())));
        return;
    }
    if (request.is_multipart_form_data()) {
        const Incoming incoming(studio.folders().incoming(""));
        ModelUpload upload(incoming.path(), longest_model);
        read_form(
            reader, [&](const std::string&, const std::string& name) { upload.begin(name); },
            [&](const char* data, std::size_t size) { upload.add(data, size); });
        const fs::path model = upload.end();
        reply_json(response, project_json(studio.open_folder(incoming.path(), model)));
        return;
    }
    const std::string name = name_of(request);
    const Incoming incoming(studio.folders().incoming(".upload"));
    save_upload(reader, incoming.path(), longest_model);
    reply_json(response, project_json(studio.open_model(incoming.path(), name)));
}

/// Stores a mask painted on the model under a new name, because waiting edits refer to older masks.
void answer_mask(Studio& studio, const HttpRequest& request, HttpResponse& response,
                 const httplib::ContentReader& reader) {
    constexpr int name_bytes = 4;
    const StudioProject project = studio.project(number_of(request, 1));
    const fs::path given = stored_name(name_of(request));
    const std::string name = given.stem().string() + "_" + random_secret(name_bytes) + ".png";
    const Incoming incoming(studio.folders().incoming(""));
    const fs::path image = incoming.path() / given;
    fs::create_directories(incoming.path());
    save_upload(reader, image, longest_image);
    load_image(image);  // throws for an invalid image
    const fs::path folder = studio.folders().project(project.id) / "masks";
    fs::create_directories(folder);
    fs::rename(image, folder / name);
    sync_tree(folder);  // a waiting edit refers to the mask
    const std::string material = request.get_param_value("material");
    reply_json(response,
               {{"name", name},
                {"selector", "mask=masks/" + name + (material.empty() ? "" : "@" + material)},
                {"url", fmt::format("api/projects/{}/masks/{}", project.id, name)}});
}

/// Stores an uploaded light as a Radiance file.
void answer_own_light(Studio& studio, const HttpRequest& request, HttpResponse& response,
                      const httplib::ContentReader& reader) {
    const fs::path given = stored_name(name_of(request));
    constexpr std::array kinds = {".hdr", ".exr", ".png", ".jpg", ".jpeg"};
    if (std::find(kinds.begin(), kinds.end(), given.extension()) == kinds.end())
        throw InputError(given.string(), "is not a light",
                         "choose an .hdr, .exr, .png or .jpg file");
    std::string name = given.stem().string();
    if (name == "sky" || result_of_light(name) || is_light_preset(name)) name = "own_" + name;
    const Incoming incoming(studio.folders().incoming(""));
    fs::create_directories(incoming.path());
    save_upload(reader, incoming.path() / given, longest_image);
    const Image light = load_light((incoming.path() / given).string());
    const fs::path folder = studio.folders().root() / "lights";
    fs::create_directories(folder);
    save_image(folder / light_file_name(name), light, 32);
    reply_json(response, {{"name", name}});
}

void answer_photographs(Studio& studio, const HttpRequest& request, HttpResponse& response,
                        const httplib::ContentReader& reader) {
    if (!request.is_multipart_form_data())
        throw InputError("photographs", "expected a form with files");
    const Incoming incoming(studio.folders().incoming(""));
    PhotographUpload upload(incoming.path(), longest_photographs);
    read_form(
        reader,
        [&](const std::string& field, const std::string& name) { upload.begin(field, name); },
        [&](const char* data, std::size_t size) { upload.add(data, size); });
    upload.end();
    constexpr std::size_t fewest = 3;
    if (upload.count() < fewest)
        throw InputError("photographs", "are too few",
                         "at least 3 are required, 30 or more are recommended");
    reply_json(response,
               result_json(studio.reconstruct(incoming.path(), request.get_param_value("name"))));
}

}  // namespace

void add_upload_routes(StudioRoutes& routes) {
    Studio& studio = routes.studio;
    const auto with_studio = [&studio](auto answer) {
        return [&studio, answer](const HttpRequest& request, HttpResponse& response,
                                 const httplib::ContentReader& reader) {
            answer(studio, request, response, reader);
        };
    };
    routes.post_stream("/api/projects", longest_model, with_studio(answer_model));
    routes.post_stream(R"(/api/projects/(\d+)/masks)", longest_image, with_studio(answer_mask));
    routes.get(R"(/api/projects/(\d+)/masks/([A-Za-z0-9_-]+\.png))",
               [&studio](const HttpRequest& request, HttpResponse& response) {
                   const StudioProject project = studio.project(number_of(request, 1));
                   reply_file(
                       request, response,
                       studio.folders().project(project.id) / "masks" / request.matches[2].str());
               });
    routes.post_stream("/api/lights", longest_image, with_studio(answer_own_light));
    routes.post_stream("/api/photographs", longest_photographs, with_studio(answer_photographs));
}

}  // namespace item3d

// OBJ and MTL in world space. Metallic and roughness become Pm, Pr, map_Pm and map_Pr (grey
// images). Normal maps become norm. Occlusion becomes map_AO, which item3d reads and other programs
// ignore.
#include "item3d/io/obj/write.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/file_names.h"
#include "item3d/io/text.h"
#include "item3d/io/texture_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace fs = std::filesystem;
namespace {

Image channel_of(const Image& image, int channel) {
    Image result(image.width, image.height, 1);
    const int from = std::min(channel, image.channels - 1);
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        result.pixels[i] = image.pixels[i * static_cast<std::size_t>(image.channels) + from];
    }
    return result;
}

// Multiplies texture values by a factor, for maps that replace their factor.
Image scaled(Image image, float factor) {
    if (factor != 1.0f) {
        for (float& value : image.pixels)
            value *= factor;
    }
    return image;
}

Image tinted(const Image& image, const Vec4& factor) {
    if (factor == Vec4(1.0f)) return image;
    Image result = image;
    const int colors = image.channels < 3 ? 1 : 3;
    for (std::size_t i = 0; i < result.pixels.size();
         i += static_cast<std::size_t>(image.channels)) {
        for (int c = 0; c < colors; ++c) {
            const float linear = srgb_to_linear(result.pixels[i + c]) * factor[c];
            result.pixels[i + c] = linear_to_srgb(linear);
        }
    }
    return result;
}

std::string one_word(std::string name) {
    for (char& c : name) {
        if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '/' || c == '\\') c = '_';
    }
    return name;
}

class ObjWriter {
  public:
    ObjWriter(const fs::path& path, const Model& model, const ModelEdit& edit)
        : folder_(path.parent_path()), stem_(path.stem().string()), model_(model), edit_(edit) {}

    void write(const fs::path& path) {
        name_materials();
        const auto box = model_.bounds();
        const float side =
            std::max({box[1].x - box[0].x, box[1].y - box[0].y, box[1].z - box[0].z});
        // The positions get two decimals more than the precision of float32 at the model's size.
        decimals_ = static_cast<int>(std::clamp(8 - std::floor(std::log10(side)), 0.0f, 17.0f));
        fmt::format_to(std::back_inserter(obj_), "# item3d\nmtllib {}.mtl\n", stem_);
        for (std::size_t i = 0; i < model_.primitives.size(); ++i)
            write_primitive(static_cast<int>(i));
        for (std::size_t i = 0; i < model_.materials.size(); ++i)
            write_material(static_cast<int>(i));
        write_atomically(folder_ / (stem_ + ".mtl"), std::string_view(mtl_));
        write_atomically(path, std::string_view(obj_));
    }

  private:
    void name_materials() {
        std::map<std::string, int> seen;
        for (const Material& material : model_.materials) {
            std::string name = one_word(material.name.empty() ? "material" : material.name);
            if (const int count = seen[name]++; count > 0) name += "_" + std::to_string(count);
            names_.push_back(name);
        }
    }

    std::string save(const Image& image, int bits, const std::string& material, const char* what,
                     const ImageCoding& coding = {}) {
        return save(encode_texture(image, coding, bits), coding.encoding, material, what);
    }

    std::string save(const Bytes& bytes, ImageEncoding encoding, const std::string& material,
                     const char* what) {
        const std::string name =
            file_names_.unused(shortened(stem_, 80) + "_" + shortened(material, 80) + "_" + what) +
            extension_of(encoding);
        write_atomically(folder_ / name, std::span<const std::uint8_t>(bytes));
        return name;
    }

    // Saves an image once for all materials that share it.
    std::string save(const EditedTexture& texture, const std::string& material, const char* what) {
        std::string& file = edited_files_[texture.identity()];
        if (file.empty()) file = save(texture.encoded(), texture.coding().encoding, material, what);
        return file;
    }

    // Saves a texture; copies the original file if the material shows it unchanged.
    std::string save(const Texture& texture, const Vec4& factor, const std::string& material,
                     const char* what) {
        if (texture.file && factor == Vec4(1.0f))
            return save(*texture.file, texture.coding.encoding, material, what);
        return save(tinted(texture.image, factor), texture.bits_per_channel, material, what);
    }

    const Texture* texture(int index) const {
        if (index < 0) return nullptr;
        const Texture& found = model_.textures[static_cast<std::size_t>(index)];
        return found.image.empty() ? nullptr : &found;
    }

    void line(const std::string& text) { mtl_ += text + "\n"; }

    static std::string clamp_option(const Texture* texture) {
        return texture && texture->wrap_u == Wrap::clamp_to_edge ? "-clamp on " : "";
    }

    void write_material(int index) {
        const Material& material = model_.materials[static_cast<std::size_t>(index)];
        const std::string& name = names_[static_cast<std::size_t>(index)];
        const auto found = edit_.materials.find(index);
        const MaterialEdit edit = found == edit_.materials.end() ? MaterialEdit{} : found->second;
        line("\nnewmtl " + name);
        const Vec4& factor = material.base_color_factor;
        const Texture* base = texture(material.base_color_texture);
        const bool has_alpha = material.alpha != Material::Alpha::opaque;
        // The alpha of the map_Kd image is used only if map_d names the same image.
        const auto write_base = [&](const std::string& file, int channels) {
            line("Kd 1 1 1\nmap_Kd " + file);
            if (has_alpha && channels % 2 == 0) line("map_d " + file);
        };
        if (edit.base_color) {
            write_base(save(edit.base_color, name, "base_color"), edit.base_color->channels);
        } else if (base) {
            write_base(
                clamp_option(base) + save(*base, Vec4(Vec3(factor), 1.0f), name, "base_color"),
                base->image.channels);
        } else {
            line(fmt::format("Kd {} {} {}", factor.x, factor.y, factor.z));
        }
        if (factor.w < 1.0f) line(fmt::format("d {}", factor.w));
        write_metallic_roughness(material, name, edit);

        const Texture* normal = texture(material.normal_texture);
        if (edit.normal) {
            line("norm " + save(edit.normal, name, "normal"));
        } else if (normal) {
            const std::string scale =
                material.normal_scale == 1.0f ? "" : fmt::format("-bm {} ", material.normal_scale);
            line("norm " + scale + clamp_option(normal) +
                 save(*normal, Vec4(1.0f), name, "normal"));
        }
        const Vec3& emission = material.emissive_factor;
        if (emission == Vec3(0.0f)) return;
        line(fmt::format("Ke {} {} {}", emission.x, emission.y, emission.z));
        if (const Texture* emissive = texture(material.emissive_texture)) {
            line("map_Ke " + clamp_option(emissive) +
                 save(*emissive, Vec4(glm::min(emission, 1.0f), 1.0f), name, "emissive"));
        }
    }

    void write_metallic_roughness(const Material& material, const std::string& name,
                                  const MaterialEdit& edit) {
        const Texture* orm = texture(material.metallic_roughness_texture);
        const Texture* occlusion = texture(material.occlusion_texture);
        if (edit.metallic_roughness) {
            const Image& image = *edit.metallic_roughness;
            const int bits = edit.metallic_roughness.bits_per_channel();
            line("Pm 1\nPr 1");
            const ImageCoding& coding = edit.metallic_roughness.coding();
            line("map_AO " + save(channel_of(image, 0), bits, name, "occlusion", coding));
            line("map_Pr " + save(channel_of(image, 1), bits, name, "roughness", coding));
            line("map_Pm " + save(channel_of(image, 2), bits, name, "metallic", coding));
            return;
        }
        line(fmt::format("Pm {}\nPr {}", material.metallic_factor, material.roughness_factor));
        if (orm) {
            const int bits = orm->bits_per_channel;
            const std::string clamp = clamp_option(orm);
            line("map_Pr " + clamp +
                 save(scaled(channel_of(orm->image, 1), material.roughness_factor), bits, name,
                      "roughness"));
            line("map_Pm " + clamp +
                 save(scaled(channel_of(orm->image, 2), material.metallic_factor), bits, name,
                      "metallic"));
        }
        if (!occlusion) return;
        Image image = channel_of(occlusion->image, 0);
        for (float& value : image.pixels)
            value = 1.0f + material.occlusion_strength * (value - 1.0f);
        line("map_AO " + clamp_option(occlusion) +
             save(image, occlusion->bits_per_channel, name, "occlusion"));
    }

    void write_position(const Vec3& p) {
        auto out = std::back_inserter(obj_);
        if (model_.origin == glm::dvec3(0.0)) {
            fmt::format_to(out, "v {} {} {}", p.x, p.y, p.z);
            return;
        }
        const glm::dvec3 sum = glm::dvec3(p) + model_.origin;
        fmt::format_to(out, "v {:.{}f} {:.{}f} {:.{}f}", sum.x, decimals_, sum.y, decimals_, sum.z,
                       decimals_);
    }

    void write_primitive(int index) {
        const Primitive& primitive = model_.primitives[static_cast<std::size_t>(index)];
        const auto found = edit_.primitives.find(index);
        const PrimitiveEdit* edit = found == edit_.primitives.end() ? nullptr : &found->second;
        const auto material_edit = edit_.materials.find(primitive.material);
        const bool drops_colors = material_edit != edit_.materials.end() &&
                                  material_edit->second.base_color &&
                                  material_edit->second.includes_vertex_colors;
        auto out = std::back_inserter(obj_);
        const std::string& name = names_[static_cast<std::size_t>(primitive.material)];
        fmt::format_to(out, "o {}\nusemtl {}\n",
                       one_word(primitive.name.empty() ? name : primitive.name), name);
        for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
            write_position(primitive.positions[i]);
            if (!primitive.colors.empty() && !drops_colors) {
                const Vec4 c = glm::clamp(primitive.colors[i], 0.0f, 1.0f);
                fmt::format_to(out, " {} {} {}", linear_to_srgb(c.x), linear_to_srgb(c.y),
                               linear_to_srgb(c.z));
            }
            obj_.push_back('\n');
        }
        for (const Vec3& n : primitive.normals)
            fmt::format_to(out, "vn {} {} {}\n", n.x, n.y, n.z);
        const std::vector<Vec2>& uvs = edit ? edit->uvs : primitive.uvs;
        for (const Vec2& uv : uvs)
            fmt::format_to(out, "vt {} {}\n", uv.x, 1.0f - uv.y);

        const std::vector<std::uint32_t>& indices = edit ? edit->indices : primitive.indices;
        for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
            obj_.push_back('f');
            for (int k = 0; k < 3; ++k) {
                const std::size_t corner = indices[t + k];
                const std::size_t vertex = edit ? edit->source_vertices.at(corner) : corner;
                fmt::format_to(out, " {}/", vertices_ + vertex + 1);
                if (!uvs.empty()) fmt::format_to(out, "{}", uvs_ + corner + 1);
                if (!primitive.normals.empty()) fmt::format_to(out, "/{}", normals_ + vertex + 1);
            }
            obj_.push_back('\n');
        }
        vertices_ += primitive.positions.size();
        normals_ += primitive.normals.size();
        uvs_ += uvs.size();
    }

    fs::path folder_;
    std::string stem_;
    const Model& model_;
    const ModelEdit& edit_;
    std::vector<std::string> names_;
    FileNames file_names_;
    std::map<const void*, std::string> edited_files_;  ///< by EditedTexture::identity
    std::string obj_;
    std::string mtl_;
    int decimals_ = 0;  ///< decimals of positions, for a model far from its origin
    std::size_t vertices_ = 0;
    std::size_t normals_ = 0;
    std::size_t uvs_ = 0;
};

}  // namespace

void write_obj(const fs::path& path, const Model& model, const ModelEdit& edit) {
    ObjWriter(path, model, edit).write(path);
}

}  // namespace item3d

#include "host/textures.h"

#include <algorithm>

#include <QFileInfo>
#include <QImage>

#include "host/host_errors.h"
#include "host/rich_parameters.h"
#include "host/vcg_bridge.h"

namespace devseg::host {

namespace {

using Allocator = vcg::tri::Allocator<CMeshO>;
using Corners = CMeshO::CoordType; // one number for each corner of a face

constexpr const char* old_u = "texcoord_before_u";
constexpr const char* old_v = "texcoord_before_v";
constexpr const char* old_page = "texture_before";
constexpr const char* stand_in = "dummy.png"; // what hosts show for images that they cannot read
constexpr const char* old_color = "color_before"; // 65536 red + 256 green + blue

template <class Model>
auto image_of(const Model& model, const std::string& name, int)
    -> decltype(model.getTexture(name)) {
    return model.getTexture(name);
}
template <class Model>
QImage image_of(const Model& model, const std::string& name, long) {
    return QImage(model.pathName() + '/' + to_qstring(name));
}

template <class Model>
auto set_image(Model& model, const QImage& image, const QString&, int)
    -> decltype(model.clearTextures()) {
    model.clearTextures();
    model.addTexture("new_layout.png", image);
}
template <class Model>
void set_image(Model& model, const QImage& image, const QString& name, long) {
    if (!image.save(model.pathName() + '/' + name))
        throw HostError("expected to write " + (model.pathName() + '/' + name).toStdString() +
                        ", found that it cannot be written; check permissions");
    model.cm.textures = {name.toStdString()};
}

plane::Image as_pixels(const QImage& image) {
    const QImage rgb = image.convertToFormat(QImage::Format_RGB888);
    plane::Image pixels{rgb.width(), rgb.height(), {}};
    for (int y = 0; y < rgb.height(); ++y) {
        const std::uint8_t* row = rgb.constScanLine(y);
        pixels.rgb.insert(pixels.rgb.end(), row, row + 3 * rgb.width());
    }
    return pixels;
}

std::vector<plane::Image> read_images(const MeshModel& model) {
    std::vector<plane::Image> images;
    for (const std::string& name : model.cm.textures)
        images.push_back(QFileInfo(to_qstring(name)).fileName() == stand_in
                             ? plane::Image()
                             : as_pixels(image_of(model, name, 0)));
    return images;
}

} // namespace

void read_textures(MeshModel& model, declare::HostMesh& host) {
    CMeshO& m = model.cm;
    auto u = Allocator::FindPerFaceAttribute<Corners>(m, old_u);
    auto v = Allocator::FindPerFaceAttribute<Corners>(m, old_v);
    const std::vector<double> page = read_face_attribute(m, old_page);
    if (!Allocator::IsValidHandle(m, u) || !Allocator::IsValidHandle(m, v) || page.empty())
        return;
    host.textures = read_images(model);
    for (std::size_t f = 0; f < m.face.size(); ++f) {
        if (m.face[f].IsD())
            continue;
        std::array<Vec2, 3> corners;
        for (int k = 0; k < 3; ++k)
            corners[static_cast<std::size_t>(k)] = {u[f][k], v[f][k]};
        host.uv_before.push_back(corners);
    }
    for (const double number : page)
        host.page_before.push_back(number >= 0.0 && number < 1e6 ? static_cast<Index>(number) : -1);
}

void keep_old_uv(MeshModel& model) {
    CMeshO& m = model.cm;
    if (m.textures.empty() || !model.hasDataMask(MeshModel::MM_WEDGTEXCOORD) ||
        vcg::tri::HasPerFaceAttribute(m, old_page))
        return;
    auto u = Allocator::GetPerFaceAttribute<Corners>(m, old_u);
    auto v = Allocator::GetPerFaceAttribute<Corners>(m, old_v);
    auto page = Allocator::GetPerFaceAttribute<Scalarm>(m, old_page);
    for (std::size_t f = 0; f < m.face.size(); ++f) {
        if (m.face[f].IsD())
            continue;
        for (int k = 0; k < 3; ++k) {
            u[f][k] = static_cast<Scalarm>(m.face[f].cWT(k).U());
            v[f][k] = static_cast<Scalarm>(m.face[f].cWT(k).V());
        }
        page[f] = static_cast<Scalarm>(m.face[f].cWT(0).N());
    }
}

void keep_old_colors(MeshModel& model) {
    CMeshO& m = model.cm;
    // Where there are charts already, the colours may be theirs.
    if (!model.hasDataMask(MeshModel::MM_FACECOLOR) ||
        vcg::tri::HasPerFaceAttribute(m, old_color) || vcg::tri::HasPerFaceAttribute(m, "chart_id"))
        return;
    auto color = face_attribute(m, old_color);
    for (std::size_t f = 0; f < m.face.size(); ++f)
        if (!m.face[f].IsD()) {
            const auto& c = m.face[f].cC();
            color[f] = static_cast<Scalarm>((c[0] * 256 + c[1]) * 256 + c[2]);
        }
}

void read_surface(MeshModel& model, declare::HostMesh& host) {
    CMeshO& m = model.cm;
    read_textures(model, host);
    if (host.uv_before.empty() && model.hasDataMask(MeshModel::MM_WEDGTEXCOORD)) {
        host.textures = read_images(model);
        host.uv_before = read_wedge_uv(m);
        for (const auto& f : m.face)
            if (!f.IsD())
                host.page_before.push_back(f.cWT(0).N());
    }
    for (const double color : read_face_attribute(m, old_color)) {
        const auto bits = static_cast<std::uint32_t>(std::clamp(color, 0.0, 16777215.0));
        const auto byte = [&](int shift) { return static_cast<std::uint8_t>(bits >> shift); };
        const declare::Color c{byte(16), byte(8), byte(0)};
        host.corner_color.push_back({c, c, c});
    }
    if (!host.corner_color.empty())
        return;
    const bool of_faces =
        model.hasDataMask(MeshModel::MM_FACECOLOR) && !vcg::tri::HasPerFaceAttribute(m, "chart_id");
    if (!of_faces && !model.hasDataMask(MeshModel::MM_VERTCOLOR))
        return;
    const auto color_of = [](const vcg::Color4b& c) { return declare::Color{c[0], c[1], c[2]}; };
    for (const auto& f : m.face)
        if (f.IsD())
            continue;
        else if (of_faces)
            host.corner_color.push_back({color_of(f.cC()), color_of(f.cC()), color_of(f.cC())});
        else
            host.corner_color.push_back(
                {color_of(f.cV(0)->cC()), color_of(f.cV(1)->cC()), color_of(f.cV(2)->cC())});
}

void replace_textures(MeshModel& model, const plane::Image& image) {
    QImage picture(image.width, image.height, QImage::Format_RGB888);
    for (int y = 0; y < image.height; ++y)
        std::copy_n(image.rgb.data() + 3 * static_cast<std::ptrdiff_t>(y) * image.width,
                    3 * image.width, picture.scanLine(y));
    const QString name = QFileInfo(model.fullName()).completeBaseName() + "_new_layout.png";
    set_image(model, picture, name, 0);
    for (auto& f : model.cm.face)
        if (!f.IsD())
            for (int k = 0; k < 3; ++k)
                f.WT(k).N() = 0;
    Allocator::DeletePerFaceAttribute(model.cm, old_u);
    Allocator::DeletePerFaceAttribute(model.cm, old_v);
    Allocator::DeletePerFaceAttribute(model.cm, old_page);
}

} // namespace devseg::host

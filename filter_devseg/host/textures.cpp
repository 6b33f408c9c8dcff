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

} // namespace

void read_textures(MeshModel& model, declare::HostMesh& host) {
    CMeshO& m = model.cm;
    auto u = Allocator::FindPerFaceAttribute<Corners>(m, old_u);
    auto v = Allocator::FindPerFaceAttribute<Corners>(m, old_v);
    const std::vector<double> page = read_face_attribute(m, old_page);
    if (!Allocator::IsValidHandle(m, u) || !Allocator::IsValidHandle(m, v) || page.empty())
        return;
    for (const std::string& name : m.textures)
        host.textures.push_back(as_pixels(image_of(model, name, 0)));
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

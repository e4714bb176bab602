// SPDX-License-Identifier: BSD-3-Clause
#include "surfel_discs.hpp"

#include <array>
#include <cmath>
#include <cstring>

namespace posefusion_ros {
namespace {

struct Vertex {
  float x, y, z;
  std::array<std::uint8_t, 4> rgba;
  float u, v;
};

/// A corner of the triangle around the unit circle, and its place in the texture.
struct Corner {
  float x, y;
};
constexpr float kRoot3 = 1.7320508F;
constexpr std::array<Corner, 3> kCorners = {{{-kRoot3, -1}, {kRoot3, -1}, {0, 2}}};
constexpr float kTextureScale = 0.25F;  // the unit circle has a quarter of the texture's width
constexpr int kTextureSize_px = 64;

constexpr char kGroup[] = "General";

std::string uniqueName(const char* what) {
  static int count = 0;
  return std::string("posefusion/") + what + std::to_string(count++);
}

/// White, opaque within the circle.
Ogre::TexturePtr makeDisc() {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(std::size_t{4} * kTextureSize_px * kTextureSize_px);
  const float middle = 0.5F * (kTextureSize_px - 1), radius = kTextureScale * kTextureSize_px;
  for (int v = 0; v < kTextureSize_px; ++v) {
    for (int u = 0; u < kTextureSize_px; ++u) {
      const bool inside =
          std::hypot(static_cast<float>(u) - middle, static_cast<float>(v) - middle) < radius;
      const std::uint8_t alpha = inside ? 255 : 0;
      pixels.insert(pixels.end(), {255, 255, 255, alpha});
    }
  }
  Ogre::DataStreamPtr stream(new Ogre::MemoryDataStream(pixels.data(), pixels.size()));
  return Ogre::TextureManager::getSingleton().loadRawData(uniqueName("disc"), kGroup, stream,
                                                          kTextureSize_px, kTextureSize_px,
                                                          Ogre::PF_BYTE_RGBA, Ogre::TEX_TYPE_2D, 0);
}

Ogre::MaterialPtr makeMaterial(const Ogre::TexturePtr& disc) {
  Ogre::MaterialPtr material =
      Ogre::MaterialManager::getSingleton().create(uniqueName("surfels"), kGroup);
  Ogre::Pass* pass = material->getTechnique(0)->getPass(0);
  pass->setLightingEnabled(false);  // the colours are those of pictures
  pass->setAlphaRejectSettings(Ogre::CMPF_GREATER_EQUAL, 128);
  Ogre::TextureUnitState* unit = pass->createTextureUnitState(disc->getName());
  unit->setTextureAddressingMode(Ogre::TextureUnitState::TAM_CLAMP);
  unit->setTextureFiltering(Ogre::TFO_NONE);
  return material;
}

Ogre::Vector3 anyAcross(const Ogre::Vector3& normal) {
  const Ogre::Vector3 other =
      std::abs(normal.x) < 0.7F ? Ogre::Vector3::UNIT_X : Ogre::Vector3::UNIT_Y;
  return normal.crossProduct(other).normalisedCopy();
}

std::array<std::uint8_t, 4> colorOf(const SurfelPoint& s) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &s.rgb, sizeof bits);
  return {static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
          static_cast<std::uint8_t>(bits), 255};
}

}  // namespace

SurfelDiscs::SurfelDiscs() : disc_(makeDisc()) {
  own_material_ = makeMaterial(disc_);
  setMaterial(own_material_);
  mRenderOp.operationType = Ogre::RenderOperation::OT_TRIANGLE_LIST;
  mRenderOp.useIndexes = false;
  mRenderOp.vertexData = new Ogre::VertexData;
  mRenderOp.vertexData->vertexCount = 0;
  Ogre::VertexDeclaration* layout = mRenderOp.vertexData->vertexDeclaration;
  layout->addElement(0, offsetof(Vertex, x), Ogre::VET_FLOAT3, Ogre::VES_POSITION);
  layout->addElement(0, offsetof(Vertex, rgba), Ogre::VET_UBYTE4_NORM, Ogre::VES_DIFFUSE);
  layout->addElement(0, offsetof(Vertex, u), Ogre::VET_FLOAT2, Ogre::VES_TEXTURE_COORDINATES);
  setBoundingBox(Ogre::AxisAlignedBox::BOX_NULL);
}

SurfelDiscs::~SurfelDiscs() {
  delete mRenderOp.vertexData;
  Ogre::MaterialManager::getSingleton().remove(own_material_);
  Ogre::TextureManager::getSingleton().remove(disc_);
}

void SurfelDiscs::hideBacks(bool hide) {
  own_material_->getTechnique(0)->getPass(0)->setCullingMode(hide ? Ogre::CULL_CLOCKWISE
                                                                  : Ogre::CULL_NONE);
}

Ogre::Real SurfelDiscs::getSquaredViewDepth(const Ogre::Camera* camera) const {
  const Ogre::Vector3 middle = getWorldBoundingBox(true).getCenter();
  return (camera->getDerivedPosition() - middle).squaredLength();
}

void SurfelDiscs::reserve(std::size_t vertices) {
  if (vertices <= capacity_) return;
  capacity_ = vertices + vertices / 2;  // a map grows
  buffer_ = Ogre::HardwareBufferManager::getSingleton().createVertexBuffer(
      sizeof(Vertex), capacity_, Ogre::HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE);
  mRenderOp.vertexData->vertexBufferBinding->setBinding(0, buffer_);
}

void SurfelDiscs::set(const std::vector<SurfelPoint>& surfels) {
  const std::size_t count = surfels.size() * kCorners.size();
  mRenderOp.vertexData->vertexCount = count;
  Ogre::AxisAlignedBox box;
  if (count > 0) {
    reserve(count);
    auto* vertex = static_cast<Vertex*>(
        buffer_->lock(0, count * sizeof(Vertex), Ogre::HardwareBuffer::HBL_DISCARD));
    for (const SurfelPoint& s : surfels) {
      const Ogre::Vector3 middle(s.x, s.y, s.z), normal(s.normal_x, s.normal_y, s.normal_z);
      const Ogre::Vector3 across = anyAcross(normal) * s.radius;
      const Ogre::Vector3 along = normal.crossProduct(across);
      const auto rgba = colorOf(s);
      for (const Corner& c : kCorners) {
        const Ogre::Vector3 p = middle + across * c.x + along * c.y;
        *vertex++ = {p.x, p.y, p.z, rgba, 0.5F + kTextureScale * c.x, 0.5F + kTextureScale * c.y};
      }
      box.merge(middle);
    }
    buffer_->unlock();
  }
  setBoundingBox(box);
  radius_ = box.isNull() ? 0 : std::max(box.getMinimum().length(), box.getMaximum().length());
  if (getParentSceneNode() != nullptr) getParentSceneNode()->needUpdate();
}

}  // namespace posefusion_ros

"""Drawing: GL device, meshes on the GPU, toon passes, the baked scene, faces, text and interface."""

from game.render.assets import encode_picture, load_character, load_picture, load_stall, save_png
from game.render.camera import CLOSEUP, HERO, Camera
from game.render.crowd import CrowdLook, CrowdMesh, CrowdView, dressed, load_crowd_mesh
from game.render.daylight import DESIGN_SHARE
from game.render.device import Device, LostContext
from game.render.frame_times import PASSES
from game.render.hud import Colour, Hud, rgba
from game.render.item_drawing import Card, ItemView, cut_item, own_triangles
from game.render.levels import DEFAULT, LEVELS, Level, level_named, pick_level
from game.render.model import CharacterMesh, CharacterModel, StaticMesh
from game.render.relief import Relief, ladder, relieve
from game.render.renderer import Renderer
from game.render.text import FontSet, MissingFont
from game.render.view import FrameView

__all__ = [
    "CLOSEUP",
    "DEFAULT",
    "DESIGN_SHARE",
    "HERO",
    "LEVELS",
    "PASSES",
    "Camera",
    "Card",
    "CharacterMesh",
    "CharacterModel",
    "Colour",
    "CrowdLook",
    "CrowdMesh",
    "CrowdView",
    "Device",
    "FontSet",
    "FrameView",
    "Hud",
    "ItemView",
    "Level",
    "LostContext",
    "MissingFont",
    "Relief",
    "Renderer",
    "StaticMesh",
    "cut_item",
    "dressed",
    "encode_picture",
    "ladder",
    "level_named",
    "load_character",
    "load_crowd_mesh",
    "load_picture",
    "load_stall",
    "own_triangles",
    "pick_level",
    "relieve",
    "rgba",
    "save_png",
]

"""Settings survive, broken files are set aside with a message, and the interface speaks both languages."""

from __future__ import annotations

import pytest

from game.app.settings import CHOICES, Settings, load_settings, save_settings
from game.app.strings import load_strings
from game.core.errors import BadInput


def test_settings_come_back_as_saved(tmp_path) -> None:
    settings = Settings(language="ja", text_speed="fast", ui_scale=1.5, captions=True, keys={"o": "x"})
    assert save_settings(settings, tmp_path) is None
    assert load_settings(tmp_path) == (settings, None)


@pytest.mark.parametrize("content", ["", "{", "[]", '"x"', "[" * 5000])
def test_broken_settings_are_reported_not_fatal(tmp_path, content: str) -> None:
    (tmp_path / "settings.json").write_text(content, encoding="utf-8")
    settings, message = load_settings(tmp_path)
    assert settings == Settings()
    assert message
    assert (tmp_path / "settings.json").read_text(encoding="utf-8") == content


def test_unknown_values_fall_back_one_by_one(tmp_path) -> None:
    (tmp_path / "settings.json").write_text('{"language": "ja", "ui_scale": 77, "captions": 1}', encoding="utf-8")
    assert load_settings(tmp_path)[0] == Settings(language="ja")


def test_every_setting_goes_round_its_values() -> None:
    for name, values in CHOICES.items():
        settings, seen = Settings(), []
        for _ in values:
            settings = settings.next(name)
            seen.append(getattr(settings, name))
        assert set(seen) == set(values)


def test_a_folder_that_cannot_be_written_is_said_in_one_line(tmp_path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("x", encoding="utf-8")
    message = save_settings(Settings(), blocked / "inner")
    assert message
    assert "\n" not in message


def test_every_text_exists_in_both_languages() -> None:
    english, japanese = load_strings("en"), load_strings("ja")
    for key in english.texts:
        assert english(key)
        assert japanese(key)
        assert english(key).count("{") == japanese(key).count("{"), key
    assert english("purse", money="¥1,240") == "Purse ¥1,240"
    with pytest.raises(BadInput, match=r"en \| ja"):
        english.switched("fr")


def test_keys_change_places_and_nothing_is_lost() -> None:
    import pygame

    from game.app.input import COMMANDS, action_of, command_of

    assert command_of("o", {}) == "o"
    keys = {"o": "p", "p": "o"}
    assert command_of("o", keys) == "p"
    assert command_of("p", keys) == "o"
    assert command_of("w", keys) == "w"
    assert command_of("o", {"o": "x"}) == "", "a key that was given away does nothing"
    pressed = pygame.event.Event(pygame.KEYDOWN, {"key": pygame.K_x, "mod": 0})
    action = action_of(pressed, 1.0, {"o": "x"})
    assert action is not None
    assert (action.key, action.raw) == ("o", "x")
    assert len(set(COMMANDS)) == len(COMMANDS)
    assert "up" not in COMMANDS


def test_nonsense_among_the_keys_is_left_out(tmp_path) -> None:
    (tmp_path / "settings.json").write_text('{"keys": {"o": "x", "zz": "y", "p": 3, "w": ""}}', encoding="utf-8")
    assert load_settings(tmp_path)[0].keys == {"o": "x"}

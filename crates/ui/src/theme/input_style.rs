//! egui's style: fonts, sizes and visuals, for a mouse or touch, with or without animation. Colours come from the
//! palette. Sizes are in screen points and times in seconds; these and opacities were chosen, not measured.

use std::sync::Arc;

use egui::epaint::text::{GlyphBitmap, GlyphRasterizer, RasterizedGlyph};
use egui::{
    Color32, ColorImage, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId,
    Margin, Shadow, Stroke, Style, TextStyle, Visuals, vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_figures::stamp;
use tilescope_session::look::Look;

use super::{semibold, theme_of};

/// The properties of the input that the style depends on, besides the colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputStyle {
    /// Whether buttons and other targets are large enough for touch.
    pub touch: bool,
    /// Whether animations are off.
    pub still: bool,
}

/// The height of targets for touch, in screen points. Buttons with an icon have 2 more, and rows and other controls 4
/// less.
pub const FINGER: f32 = 40.0;

/// Gives `ctx` the fonts, and the colours of `look`.
pub fn install(ctx: &Context, look: Look) {
    ctx.set_fonts(fonts());
    ctx.add_glyph_rasterizer(code_points());
    restyle(ctx, look, InputStyle::default());
}

/// Gives `ctx` the colours of a look, and sizes for mouse or touch.
pub fn restyle(ctx: &Context, look: Look, input: InputStyle) {
    let theme = theme_of(look);
    ctx.set_style_of(theme, style(Palette::of(look), input));
    ctx.set_theme(theme);
    ctx.data_mut(|data| data.insert_temp(touch_id(), input.touch));
}

fn touch_id() -> egui::Id {
    egui::Id::unique("made for fingers")
}

/// Returns whether buttons should be large enough for touch.
#[must_use]
pub fn is_for_fingers(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(touch_id()).unwrap_or(false))
}

/// Returns the height of a clickable row: `height`, or the minimum for touch.
#[must_use]
pub fn row_height(ctx: &Context, height: f32) -> f32 {
    if is_for_fingers(ctx) {
        height.max(FINGER - 4.0)
    } else {
        height
    }
}

/// Returns the fonts for letters that the project's own fonts lack.
#[cfg(not(target_arch = "wasm32"))]
fn fallback_fonts() -> FontDefinitions {
    FontDefinitions::default()
}

/// Returns the fonts for letters that the project's own fonts lack: none on a page, where eframe lets the browser draw them.
#[cfg(target_arch = "wasm32")]
fn fallback_fonts() -> FontDefinitions {
    FontDefinitions::empty()
}

fn fonts() -> FontDefinitions {
    with_own_fonts(fallback_fonts())
}

/// Returns `fonts` with the project's own fonts before them in each family. A letter that a family's own font lacks is looked for
/// in the project's other fonts, and then in the fallback fonts.
fn with_own_fonts(mut fonts: FontDefinitions) -> FontDefinitions {
    let embedded: [(&str, &'static [u8], FontFamily); 3] = [
        (
            "Inter",
            include_bytes!("../../../../assets/fonts/Inter-Regular.otf"),
            FontFamily::Proportional,
        ),
        (
            "Inter SemiBold",
            include_bytes!("../../../../assets/fonts/Inter-SemiBold.otf"),
            semibold(),
        ),
        (
            "JetBrains Mono",
            include_bytes!("../../../../assets/fonts/JetBrainsMono-Regular.ttf"),
            FontFamily::Monospace,
        ),
    ];
    let proportional = fonts.families.get(&FontFamily::Proportional).cloned();
    // egui's own fonts have this family. Fonts without this family have no fallback.
    let fallback = proportional.unwrap_or_default();

    for (name, bytes, family) in &embedded {
        let data = Arc::new(FontData::from_static(bytes));
        fonts.font_data.insert((*name).to_owned(), data);
        let others = embedded.iter().map(|(other, ..)| *other);
        // The own font comes first, then the other two, which may have a letter that it lacks.
        let own = std::iter::once(*name).chain(others.filter(|other| other != name));
        // egui has no family for headings, so that they fall back to the fonts of the text.
        let names = fonts
            .families
            .entry(family.clone())
            .or_insert(fallback.clone());
        names.splice(0..0, own.map(str::to_owned));
    }
    fonts
}

/// Returns what draws letters that no font has, neither those of the program nor those of the system or the browser: as
/// boxes that hold their code points, as in pictures. The fonts' own empty boxes would make words that differ look
/// alike.
fn code_points() -> GlyphRasterizer {
    GlyphRasterizer::new("tilescope::code-points", |request| {
        let drawn = stamp(request.cluster, f64::from(request.font_size_px))?;
        let size = [drawn.pixels.width, drawn.pixels.height].map(|side| side as usize);
        // The opacities suffice, since egui gives letters their colour.
        let opacities = drawn.pixels.rgba.chunks_exact(4).map(|pixel| pixel[3]);
        let image = ColorImage::new(size, opacities.map(Color32::from_white_alpha).collect());

        let bitmap = GlyphBitmap {
            image,
            offset_px: vec2(request.subpixel_offset_px, -(drawn.baseline as f32)),
            is_color: false,
        };
        Some(RasterizedGlyph {
            bitmap,
            advance_px: drawn.advance as f32,
        })
    })
}

/// Returns the style of a palette for an input. Sizes are in screen points.
fn style(palette: &Palette, input: InputStyle) -> Style {
    let mut style = Style {
        visuals: visuals(palette),
        animation_time: if input.still { 0.0 } else { 0.12 },
        ..Style::default()
    };

    let fonts = [
        (TextStyle::Small, 11.5, FontFamily::Proportional),
        (TextStyle::Body, 13.5, FontFamily::Proportional),
        (TextStyle::Button, 13.5, FontFamily::Proportional),
        (TextStyle::Heading, 15.0, semibold()),
        (TextStyle::Monospace, 12.5, FontFamily::Monospace),
    ];
    for (name, size, family) in fonts {
        style.text_styles.insert(name, FontId::new(size, family));
    }

    style.spacing.item_spacing = vec2(8.0, 5.0);
    style.spacing.button_padding = vec2(9.0, 4.0);
    style.spacing.interact_size.y = 24.0;
    style.spacing.window_margin = Margin::same(18);
    style.interaction.tooltip_delay = 0.25;

    // A finger needs larger targets than a mouse.
    if input.touch {
        style.spacing.button_padding = vec2(12.0, 8.0);
        style.spacing.interact_size = vec2(48.0, FINGER - 4.0);
        style.spacing.icon_width = 20.0;
        style.spacing.icon_width_inner = 12.0;
        style.spacing.window_margin = Margin::same(12);
    }

    if input.still {
        // egui animates scrolling apart from everything else.
        style.scroll_animation = egui::style::ScrollAnimation::none();
    }

    style
}

/// Returns egui's visuals in the colours of a palette.
fn visuals(palette: &Palette) -> Visuals {
    let mut visuals = if palette.dark {
        Visuals::dark()
    } else {
        Visuals::light()
    };
    let corner = CornerRadius::same(6);

    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(10);
    visuals.menu_corner_radius = CornerRadius::same(8);
    visuals.window_shadow = Shadow {
        offset: [0, 8],
        blur: 28,
        spread: 0,
        color: Color32::from_black_alpha(if palette.dark { 130 } else { 50 }),
    };

    visuals.extreme_bg_color = palette.raised;
    visuals.faint_bg_color = palette.raised;
    visuals.selection.bg_fill = palette.accent.gamma_multiply(0.35);
    visuals.selection.stroke = Stroke::new(1.0, palette.accent);
    visuals.hyperlink_color = palette.accent;
    visuals.weak_text_color = Some(palette.muted);
    visuals.error_fg_color = palette.conflict;
    visuals.warn_fg_color = palette.margin;

    let hover = palette.text.gamma_multiply(0.08);
    let states = [
        (&mut visuals.widgets.noninteractive, Color32::TRANSPARENT),
        (&mut visuals.widgets.inactive, palette.raised),
        (&mut visuals.widgets.hovered, palette.raised.blend(hover)),
        (&mut visuals.widgets.active, palette.raised.blend(hover)),
        (&mut visuals.widgets.open, palette.raised),
    ];

    for (state, fill) in states {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::new(1.0, palette.line);
        state.fg_stroke = Stroke::new(1.0, palette.text);
        state.corner_radius = corner;
        // By default, egui enlarges a widget under the pointer.
        state.expansion = 0.0;
    }

    visuals.widgets.hovered.bg_stroke.color = palette.muted;
    visuals.widgets.active.bg_stroke.color = palette.accent;
    visuals.disabled_alpha = 0.45;
    // A blinking cursor would redraw the whole window twice a second while a field has the focus.
    visuals.text_cursor.blink = false;
    visuals
}

#[cfg(test)]
mod tests {
    use egui::epaint::text::GlyphRasterizerRequest;

    use super::*;
    #[test]
    fn a_page_has_every_sign_of_the_window_in_fonts_of_its_own() {
        // Besides those of the labels, the signs in names, sentences and pseudocode.
        let signs = include_str!("../../../../assets/lesson-labels.json");
        let signs = signs.chars().chain("\u{b1}\u{b2}\u{b5}\u{d7}\u{2080}\u{2081}\u{2190}\u{2191}\u{2192}\u{2193}\u{2212}\u{221a}".chars());
        let mut fonts = egui::epaint::text::Fonts::new(
            egui::epaint::TextOptions::default(),
            with_own_fonts(FontDefinitions::empty()),
        );
        let mut view = fonts.with_pixels_per_point(1.0);
        for family in [FontFamily::Proportional, semibold(), FontFamily::Monospace] {
            let font = FontId::new(13.0, family);
            for sign in signs.clone().filter(|sign| !sign.is_control()) {
                assert!(view.has_glyph(&font, sign), "{sign:?} in {font:?}");
            }
            // A letter that no font of the project has: the browser draws it.
            assert!(!view.has_glyph(&font, '\u{4e2d}'), "{font:?}");
        }
    }

    #[test]
    fn letters_that_no_font_has_are_boxes_that_differ() {
        let drawn = |cluster: &str, font_size_px: f32| {
            let family = FontFamily::Proportional;
            (code_points().rasterize)(&GlyphRasterizerRequest {
                cluster,
                family: &family,
                font_size_px,
                subpixel_offset_px: 0.0,
            })
        };
        let [a, b] = ["\u{70b9}", "\u{96c6}"].map(|cluster| drawn(cluster, 14.0).unwrap());
        assert_ne!(a.bitmap.image, b.bitmap.image);
        assert!(
            a.advance_px > 7.0 && a.advance_px < 21.0,
            "{}",
            a.advance_px
        );
        let larger = drawn("\u{70b9}", 28.0).unwrap();
        assert!(larger.bitmap.image.size[0] > a.bitmap.image.size[0]);
    }

    #[test]
    fn the_window_has_the_boxes() {
        let ctx = Context::default();
        install(&ctx, Look::Dark);
        // Without a rasterizer, a letter that no font has would end the pass.
        ctx.set_missing_glyph_policy(egui::epaint::text::MissingGlyphPolicy::Panic);
        let _ = ctx.run_ui(egui::RawInput::default(), |ui| {
            ui.label("\u{70b9}\u{96c6} \u{915}\u{94d} \u{e000}");
        });
    }
}

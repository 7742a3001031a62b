//! The window: paints the state and turns clicks, drags and drops into changes of it.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex, mpsc},
};

use eframe::egui::{
    self, CentralPanel, Color32, ColorImage, Panel, Pos2, Rect, RichText, Sense, TextureHandle, TextureOptions, Ui,
    ViewportBuilder, ViewportCommand,
};
use image::RgbImage;

use crate::{cli::AppStart, export, relief::View};

use super::{
    drawing::{Drawing, Drawn},
    state::State,
};

/// Textures of this side are everywhere; a larger world is shown averaged.
const MOST_PX: usize = 2048;
const SIZE: [f32; 2] = [1180.0, 760.0];
/// Frames until a new window has settled.
const SETTLED: u32 = 4;

/// Opens the window and stays until it is closed.
pub fn open(start: AppStart) -> Result<(), String> {
    let viewport = ViewportBuilder::default().with_inner_size(SIZE).with_title("Upthrust").with_app_id("upthrust");
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let failure = Arc::new(Mutex::new(None));
    let told = Arc::clone(&failure);
    let make: eframe::AppCreator = Box::new(|context| Ok(Box::new(Window::new(start, &context.egui_ctx, told)?)));
    eframe::run_native("upthrust", options, make).map_err(|e| no_window(&e))?;
    let failed = failure.lock().ok().and_then(|mut failure| failure.take());
    failed.map_or(Ok(()), Err)
}

fn no_window(error: &eframe::Error) -> String {
    match error {
        eframe::Error::Wgpu(_) => format!(
            "the window has no graphics adapter: {error}; install a Vulkan driver (package mesa-vulkan-drivers on \
             Debian and Ubuntu)"
        ),
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => {
            // What comes before is a place in the window library's source.
            let text = error.to_string();
            let why = text.rsplit_once(": ").map_or(text.as_str(), |(_, why)| why);
            format!("no window can be opened: {}", why.trim_end_matches('.'))
        }
        _ => format!("no window can be opened: {error}"),
    }
}

struct Window {
    state: State,
    drawing: Drawing,
    texture: Option<TextureHandle>,
    pointed: Option<[usize; 2]>,
    snapshot: Option<Snapshot>,
}

impl Window {
    fn new(start: AppStart, context: &egui::Context, failure: Arc<Mutex<Option<String>>>) -> std::io::Result<Self> {
        let wake = context.clone();
        let mut state = State { overlay: true, ..State::default() };
        if let Some((name, world)) = start.world {
            state.show(name, world);
        }
        Ok(Self {
            state,
            drawing: Drawing::start(MOST_PX, move || wake.request_repaint())?,
            texture: None,
            pointed: None,
            snapshot: start.screenshot.map(|file| Snapshot::new(file, failure)),
        })
    }

    fn draw_anew(&mut self, context: &egui::Context) {
        if let Some(wanted) = self.state.wanted() {
            self.drawing.want(wanted);
        }
        let Some(Drawn { wanted, picture }) = self.drawing.take() else { return };
        match picture {
            Ok(picture) => {
                let size = [picture.width() as usize, picture.height() as usize];
                let image = ColorImage::from_rgb(size, picture.as_raw());
                // Identities and classes have no values between them.
                let smooth = !matches!(wanted.view, View::Layer(_));
                let filter = if smooth { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
                self.texture = Some(context.load_texture("map", image, filter));
            }
            Err(complaint) => self.state.complaint = Some(complaint),
        }
    }

    fn side(&mut self, ui: &mut Ui) {
        ui.add_space(6.0);
        match &self.state.opened {
            Some(opened) => {
                let grid = opened.world.grid;
                let [wide, tall] = grid.extent_m().map(|m| m / 1000.0);
                ui.heading(opened.name.as_str());
                ui.label(format!("{} x {} cells, {wide:.0} x {tall:.0} km", grid.width, grid.height));
                ui.label(format!("{:.1} million years", opened.world.time_yr / 1e6));
            }
            None => {
                ui.heading("Upthrust");
            }
        }
        ui.separator();
        for (view, title) in self.state.views() {
            if ui.selectable_label(self.state.view == view, title).clicked() {
                self.state.view = view;
            }
        }
        if self.state.has_plates() {
            ui.separator();
            ui.checkbox(&mut self.state.overlay, "Plate borders and motions");
        }
        if let Some(opened) = &mut self.state.opened
            && ui.button("Whole map").clicked()
        {
            opened.camera.fit();
        }
        ui.separator();
        if let Some(complaint) = &self.state.complaint {
            ui.label(RichText::new(complaint).color(Color32::from_rgb(0xd2, 0x60, 0x4f)));
            ui.separator();
        }
        self.numbers(ui);
    }

    fn numbers(&self, ui: &mut Ui) {
        let (Some(opened), Some(cell)) = (&self.state.opened, self.pointed) else {
            ui.weak("Point at the map for its numbers. Drag to move, scroll to zoom, double-click for the whole map.");
            return;
        };
        egui::Grid::new("numbers").num_columns(2).striped(true).show(ui, |ui| {
            for (what, value) in opened.readout(cell) {
                ui.label(what);
                ui.monospace(value);
                ui.end_row();
            }
        });
    }

    fn map(&mut self, ui: &mut Ui) {
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
        let Some(opened) = &mut self.state.opened else {
            let text = "Drop the folder of a world here,\nor start with one: upthrust app WORLD";
            let font = egui::FontId::proportional(18.0);
            painter.text(response.rect.center(), egui::Align2::CENTER_CENTER, text, font, Color32::GRAY);
            self.pointed = None;
            return;
        };
        let corner = response.rect.min;
        let inside = |at: Pos2| [f64::from(at.x - corner.x), f64::from(at.y - corner.y)];
        let camera = &mut opened.camera;
        camera.resize([f64::from(response.rect.width()), f64::from(response.rect.height())]);
        let moved = response.drag_delta();
        camera.drag([f64::from(moved.x), f64::from(moved.y)]);
        if response.double_clicked() {
            camera.fit();
        }
        let hovered = response.hover_pos();
        if let Some(at) = hovered {
            let (pinch, scroll) = ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta().y));
            camera.zoom(f64::from(pinch) * f64::from(scroll / 240.0).exp2(), inside(at));
        }
        self.pointed = hovered.and_then(|at| camera.cell(inside(at)));
        if let Some(texture) = &self.texture {
            let point = |cell: [f64; 2]| {
                let at = camera.to_window(cell);
                Pos2::new(corner.x + at[0] as f32, corner.y + at[1] as f32)
            };
            let grid = opened.world.grid;
            let area = Rect::from_min_max(point([0.0; 2]), point([grid.width as f64, grid.height as f64]));
            let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(texture.id(), area, whole, Color32::WHITE);
        }
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let dropped = ui.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_owned()));
        if let Some(path) = dropped {
            self.state.open(&path);
        }
        self.draw_anew(ui.ctx());
        Panel::right("side").default_size(250.0).show(ui, |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| self.side(ui));
        });
        CentralPanel::no_frame().show(ui, |ui| self.map(ui));
        if self.drawing.pending() {
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(100));
        } else if let Some(snapshot) = &mut self.snapshot {
            snapshot.advance(ui.ctx());
        }
    }
}

/// A picture of the window itself: waits until it stands, takes it, writes it, closes the window.
struct Snapshot {
    file: PathBuf,
    frames: u32,
    taken: Option<mpsc::Receiver<Arc<ColorImage>>>,
    failure: Arc<Mutex<Option<String>>>,
}

impl Snapshot {
    fn new(file: PathBuf, failure: Arc<Mutex<Option<String>>>) -> Self {
        Self { file, frames: 0, taken: None, failure }
    }

    fn advance(&mut self, context: &egui::Context) {
        self.frames += 1;
        context.request_repaint();
        if self.frames < SETTLED {
            return;
        }
        let Some(taken) = &self.taken else {
            let (tell, taken) = mpsc::channel();
            context.request_screenshot(move |image| {
                let _ = tell.send(image);
            });
            self.taken = Some(taken);
            return;
        };
        if let Ok(image) = taken.try_recv() {
            if let Err(error) = self.write(&image)
                && let Ok(mut failure) = self.failure.lock()
            {
                *failure = Some(error);
            }
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    fn write(&self, image: &ColorImage) -> Result<(), String> {
        let [width, height] = image.size.map(|n| n as u32);
        let bytes = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
        let picture = RgbImage::from_raw(width, height, bytes).ok_or("the window gave half a picture")?;
        export::write_picture(&picture, &self.file).map_err(|e| e.to_string())
    }
}

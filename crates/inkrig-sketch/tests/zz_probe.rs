use inkrig_sketch::*;
use std::time::Instant;
fn t(name:&str, f: impl FnOnce()->Result<Curve,SketchError>) { let s=Instant::now(); let r=f(); let d=s.elapsed(); let st=std::fs::read_to_string("/proc/self/status").unwrap(); let hwm=st.lines().find(|l|l.starts_with("VmHWM")).unwrap().to_string();
 eprintln!("{name}: {:?} {hwm} {}", d, match r {Ok(c)=>format!("{} points", c.point_count()),Err(e)=>e.to_string().chars().take(160).collect()}); }
fn svg(b:String)->Result<Curve,SketchError>{ read_curve(format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 10 10' stroke='red'>{b}</svg>").as_bytes(), Format::Svg)}
#[test] fn probe() {
 t("curves 900k json", || { let s: String=(0..900000).map(|i|format!("[{i},{}],", i*7%13)).collect(); read_curve(format!("[{s}[1,1]]").as_bytes(),Format::Json)});
 t("json empty strokes", || read_curve(format!("{{\"strokes\":[{}[]]}}", "[],".repeat(20<<20)).as_bytes(),Format::Json));
 t("json one-point strokes", || read_curve(format!("{{\"strokes\":[{}[]]}}", "[[0,0]],".repeat(900_000)).as_bytes(),Format::Json));
 t("svg cubic round stroke", || svg(format!("<path stroke-width='3' stroke-linejoin='round' d='M0 0{}'/>", "c1 1 0 5 3-3".repeat(60000))));
 t("svg hv 14MiB", || svg(format!("<path d='M0 0{}'/>", "h1".repeat(7<<20))));
 t("svg quads wild", || svg(format!("<path d='M0 0{}'/>", "q9 9-9 9".repeat(200000))));
 t("svg cubic wild", || svg(format!("<path d='M0 0{}'/>", "c9-9-9 99 9 9".repeat(200000))));
 t("svg arcs", || svg(format!("<path d='M0 0{}'/>", "a1 9 9 0 1 5 5".repeat(400000))));
 t("99k paths", || svg("<path d='M0 0L1 1'/>".repeat(99_000)));
 t("rules 1000 x 19k", || svg(format!("<style>{}</style>{}", ".a{fill:none}".repeat(1000), "<path class='b a' d='M0 0L1 1'/>".repeat(19_000))));
 t("many class tokens", || svg(format!("<style>{}</style>{}", ".a{fill:none}".repeat(1000), format!("<path class='{}' d='M0 0L1 1'/>", "b ".repeat(1<<9)).repeat(15_000))));
 t("attr per tag", || svg(format!("<g {}/>", (0..250).map(|i|format!("a{i}='' ")).collect::<String>()).repeat(25_000)));
 t("transform list", || svg(format!("<g transform='{}'><path d='M0 0L1 1'/></g>", "scale(1)".repeat(1<<20))));
 t("depth 120", || svg(format!("{}<path d='M0 0L1 1'/>{}", "<g opacity='.9' transform='scale(.99)'>".repeat(120), "</g>".repeat(120))));
 t("depth 120 svg", || svg(format!("{}<path d='M0 0L1 1'/>{}", "<svg width='9' height='9'>".repeat(120), "</svg>".repeat(120))));
 let syms: String=(0..60).map(|i|format!("<symbol id='s{i}' viewBox='0 0 9 9'><use href='#s{}'/></symbol>", i+1)).collect();
 t("depth symbols", || svg(format!("{syms}<symbol id='s60'><path d='M0 0L1 1'/></symbol><use href='#s0'/>")));
 t("comments", || svg("<!---->".repeat(9<<20)));
 t("lt", || read_curve("<".repeat(60<<20).as_bytes(), Format::Svg));
 t("quotes", || read_curve("<a ".repeat(20<<20).as_bytes(), Format::Svg));
 t("doctype", || read_curve(format!("<!DOCTYPE a [{}]><svg/>", "<!ENTITY a ''>".repeat(4<<20)).as_bytes(), Format::Svg));
 t("doctype refs", || read_curve(format!("<!DOCTYPE a [{}]><svg><path d='{}'/></svg>", (0..100_000).map(|i|format!("<!ENTITY a{i} ''>")).collect::<String>(), "&a99999;".repeat(100_000)).as_bytes(), Format::Svg));
 t("xmlns", || svg(format!("{}{}", (0..120).map(|i|format!("<g {}>", (0..200).map(|j|format!("xmlns:a{i}_{j}='b{i}_{j}' ")).collect::<String>())).collect::<String>(), "</g>".repeat(120))));
 t("xmlns wide", || svg(format!("<g {}/>", (0..250).map(|j|format!("xmlns:a{j}='b{j}' ")).collect::<String>()).repeat(10_000)));
 t("csv quotes", || read_curve("\"a,\n".repeat(10<<20).as_bytes(), Format::Csv));
 t("csv comments", || read_curve("#\n".repeat(30<<20).as_bytes(), Format::Csv));
 t("css braces", || svg(format!("<style>{}</style>", "@a{".repeat(1<<20))));
 t("css commas", || svg(format!("<style>{}{{fill:red}}</style>", "a,".repeat(1<<22))));
 t("css comments", || svg(format!("<style>{}</style>", "/**/".repeat(1<<22))));
 t("same id uses", || svg(format!("<g id='a'><path d='M0 0L1 1'/></g>{}", "<use href='#a'/>".repeat(30_000))));
}
#[test] fn probe2() {
 t("arcs wild", || svg(format!("<path d='M0 0{}'/>", "a1e15 2e-5 9 1 1 1e15 0".repeat(60000))));
 t("cubic wild2", || svg(format!("<path d='M0 0{}'/>", "c1e15-1e15-1e15 1e15 1e-15 1e-9".repeat(100000))));
 t("quad wild2", || svg(format!("<path d='M0 0{}'/>", "q1e9-1e-9 1e-15 1e-9".repeat(100000))));
 t("rects wild", || svg("<rect width='1e9' height='1e9' rx='9e8' ry='1e-5' stroke='red'/>".repeat(90000)));
 t("use x path", || svg(format!("<path id='a' d='M0 0{}'/>{}", "h1".repeat(900), "<use href='#a'/>".repeat(8000))));
 t("moves", || svg(format!("<path d='{}'/>", "M1 1".repeat(900_000))));
 t("points", || svg(format!("<polygon points='{}'/>", "1 1 ".repeat(900_000))));
 t("nested pct", || svg(format!("{}<rect width='100%' height='100%' rx='50%'/>{}", "<svg width='100%' height='100%' viewBox='0 0 1e-9 1e-9'>".repeat(100), "</svg>".repeat(100))));
}

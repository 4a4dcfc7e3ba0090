//! Ray workloads: order, shape, distribution and determinism of the batches.

use dacrt::workloads::{
    AreaLight, Camera, Film, Lens, MAX_BOUNCES, Mirror, RayType, Rays, View, Workload,
    WorkloadError, generated_cameras,
};
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use glam::{DVec3, Vec3};

/// Nearest hits by brute force in float64.
fn brute_force(mesh: &Mesh, batch: &Batch) -> Hits {
    let mut hits = Hits::misses(batch.len());
    for (i, ray) in batch.iter().enumerate() {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        for (prim, triangle) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
            let (e1, e2) = (b - a, c - a);
            let p = d.cross(e2);
            let det = e1.dot(p);
            let s = o - a;
            let q = s.cross(e1);
            let (u, v) = (s.dot(p) / det, d.dot(q) / det);
            let t = (e2.dot(q) / det) as f32;
            let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
            if inside && t > ray.tmin && t <= ray.tmax && t < hits.t[i] {
                hits.t[i] = t;
                hits.prim[i] = prim as u32;
            }
        }
    }
    hits
}

/// A room of 4 × 3 × 4 without a ceiling, and a tilted triangle in the middle.
fn room() -> Mesh {
    let p = |x: u32| {
        Vec3::new(
            if x & 1 == 0 { -2.0 } else { 2.0 },
            if x & 2 == 0 { 0.0 } else { 3.0 },
            if x & 4 == 0 { -2.0 } else { 2.0 },
        )
    };
    let mut triangles = vec![Triangle::new(
        Vec3::new(-0.7, 0.3, -0.5),
        Vec3::new(0.9, 1.1, -0.2),
        Vec3::new(0.1, 0.6, 0.8),
    )];
    for [a, b, c, d] in [
        [0, 1, 5, 4],
        [0, 1, 3, 2],
        [4, 5, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ] {
        triangles.push(Triangle::new(p(a), p(b), p(c)));
        triangles.push(Triangle::new(p(a), p(c), p(d)));
    }
    Mesh::new(triangles)
}

fn camera() -> Camera {
    let eye = DVec3::new(-1.7, 2.2, 1.6);
    Camera::new(eye, LOOK_AT.as_dvec3(), DVec3::Y, 90.0).unwrap()
}

const LOOK_AT: Vec3 = Vec3::new(0.2, 1.2, 0.0);
const LIGHT: Vec3 = Vec3::new(0.5, 2.5, 0.3);

/// The floor and the first wall are mirrors.
fn view() -> View {
    View {
        camera: camera(),
        point_light: Some(LIGHT),
        area_light: Some(AREA),
        mirrors: vec![
            Mirror::Plane {
                point: DVec3::new(7.0, 0.0, 1.0),
                normal: -3.0 * DVec3::Y,
            },
            Mirror::Triangles(3..5),
        ],
    }
}

/// The same through a lens.
fn view_with_lens() -> View {
    View {
        camera: camera().with_lens(LENS).unwrap(),
        ..view()
    }
}

const AREA: AreaLight = AreaLight {
    corner: DVec3::new(-0.5, 2.8, -0.4),
    edges: [DVec3::new(1.0, 0.1, 0.0), DVec3::new(0.2, 0.0, 0.9)],
};
const LENS: Lens = Lens {
    radius: 0.05,
    focus: 2.5,
};

fn rays_of(mesh: &Mesh, film: Film, seed: u64, ray_type: RayType) -> Rays {
    Workload::new(mesh, view(), film, seed)
        .unwrap()
        .rays(ray_type, &mut |batch| brute_force(mesh, batch))
        .unwrap()
}

/// FNV-1a over the eight floats of each ray.
fn fingerprint(batch: &Batch) -> u64 {
    batch
        .iter()
        .flat_map(|r| {
            let [o, d] = [r.origin, r.direction].map(|v| v.to_array());
            [o[0], o[1], o[2], r.tmin, d[0], d[1], d[2], r.tmax]
        })
        .flat_map(|x| x.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |h, byte| {
            (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

#[test]
fn names_go_both_ways() {
    for ray_type in RayType::ALL {
        assert_eq!(ray_type.to_string().parse(), Ok(ray_type));
    }
    assert_eq!(RayType::ALL.len(), 7 + MAX_BOUNCES as usize);
    assert_eq!(
        format!("{:>8}|{:>11}", RayType::Random, RayType::Diffuse(3)),
        "  random|  diffuse-3"
    );
    for name in ["diffuse-0", "diffuse-9", "Primary", ""] {
        let message = name.parse::<RayType>().unwrap_err().to_string();
        assert!(message.contains(&format!("`{name}`")), "{message}");
        assert!(message.contains("ambient-occlusion"), "{message}");
    }
    let any: Vec<_> = RayType::ALL
        .into_iter()
        .filter(|r| r.is_any_hit())
        .collect();
    let expected = [
        RayType::ShadowPoint,
        RayType::ShadowArea,
        RayType::AmbientOcclusion,
    ];
    assert_eq!(any, expected);
}

#[test]
fn pixels_come_by_tiles_and_each_as_often_as_it_has_samples() {
    for (width, height, spp) in [
        (1, 1, 1),
        (8, 8, 4),
        (20, 13, 9),
        (7, 30, 1),
        (33, 5, 4),
        (16, 17, 1),
    ] {
        let film = Film::new(width, height, spp).unwrap();
        assert_eq!(film.rays(), (width * height * spp) as usize);
        let mut count = vec![0; (width * height) as usize];
        let mut order = Vec::new();
        for ray in 0..film.rays() {
            let (x, y) = film.pixel(ray);
            assert!(x < width && y < height);
            count[(y * width + x) as usize] += 1;
            order.push((y / 8, x / 8, y, x));
        }
        assert!(count.iter().all(|&c| c == spp), "{width}x{height}");
        assert!(order.is_sorted(), "{width}x{height}");
    }
}

#[test]
fn pixel_of_the_widest_and_the_highest_picture() {
    let wide = Film::new(u32::MAX - 1, 1, 1).unwrap();
    assert_eq!(wide.pixel(wide.rays() - 1), (u32::MAX - 2, 0));
    let high = Film::new(1, u32::MAX - 1, 1).unwrap();
    assert_eq!(high.pixel(high.rays() - 1), (0, u32::MAX - 2));
}

#[test]
fn primary_rays_share_the_eye_and_look_where_the_camera_does() {
    let film = Film::new(9, 7, 1).unwrap();
    let rays = rays_of(&room(), film, 0, RayType::Primary);
    assert_eq!(rays.batch.len(), 63);
    assert_eq!(rays.batch.shared_origin(), Some(camera().eye()));
    for (i, ray) in rays.batch.iter().enumerate() {
        assert!(ray.is_valid() && ray.tmin == 0.0 && ray.tmax == f32::INFINITY);
        assert!((ray.direction.as_dvec3().length() - 1.0).abs() < 2f64.powi(-22));
        assert_eq!(rays.primary(i), i);
        let forward = (LOOK_AT - camera().eye()).normalize();
        let (x, y) = film.pixel(i);
        if (x, y) == (4, 3) {
            assert!(
                ray.direction.distance(forward) < 1e-6,
                "the middle looks ahead"
            );
        }
        // The eye looks down, so up in the picture is up in the scene.
        let right = forward.cross(Vec3::Y);
        assert_eq!(ray.direction.dot(right) > 1e-6, x > 4);
        let up = right.cross(forward);
        if y != 3 {
            assert_eq!(ray.direction.dot(up) > 0.0, y < 3);
        }
    }
}

#[test]
fn field_of_view_spans_the_picture_from_top_to_bottom() {
    let camera = Camera::new(DVec3::ZERO, -DVec3::Z, DVec3::Y, 90.0).unwrap();
    let s = 0.5f32.sqrt();
    let close = |d: Vec3, e: Vec3| assert!(d.distance(e) < 1e-6, "{d} {e}");
    close(camera.direction(0.5, 0.0, 2.0), Vec3::new(0.0, s, -s));
    close(camera.direction(0.5, 1.0, 2.0), Vec3::new(0.0, -s, -s));
    close(
        camera.direction(1.0, 0.5, 2.0),
        Vec3::new(2.0, 0.0, -1.0).normalize(),
    );
    close(
        camera.direction(0.0, 0.5, 2.0),
        Vec3::new(-2.0, 0.0, -1.0).normalize(),
    );
}

#[test]
fn many_samples_are_the_rays_of_a_finer_picture() {
    let mesh = room();
    let sorted = |film| {
        let mut rays: Vec<_> = rays_of(&mesh, film, 0, RayType::Primary)
            .batch
            .iter()
            .map(|r| r.direction.to_array().map(f32::to_bits))
            .collect();
        rays.sort();
        rays
    };
    let (coarse, fine) = (Film::new(12, 9, 16).unwrap(), Film::new(48, 36, 1).unwrap());
    assert_eq!(sorted(coarse), sorted(fine));
}

#[test]
fn secondary_rays_start_on_the_side_that_the_ray_came_from() {
    let mesh = room();
    let film = Film::new(24, 24, 1).unwrap();
    let primary = rays_of(&mesh, film, 3, RayType::Primary).batch;
    let hits = brute_force(&mesh, &primary);
    assert!(
        hits.hit_count() > 100 && hits.hit_count() < film.rays(),
        "some rays must miss"
    );
    let offset = 1e-4 * (16.0 + 9.0 + 16.0f64).sqrt();
    for ray_type in [RayType::Diffuse(1), RayType::AmbientOcclusion] {
        let rays = rays_of(&mesh, film, 3, ray_type);
        assert_eq!(rays.batch.len(), hits.hit_count());
        let mut expected = (0..film.rays()).filter(|&i| hits.t[i] < f32::INFINITY);
        for (k, ray) in rays.batch.iter().enumerate() {
            let i = rays.primary(k);
            assert_eq!(Some(i), expected.next(), "order of the parents");
            let triangle = &mesh.triangles()[hits.prim[i] as usize];
            let incoming = primary.ray(i);
            let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
            let normal = (b - a).cross(c - a).normalize();
            let side = -normal.dot(incoming.direction.as_dvec3()).signum();
            let height = side * normal.dot(ray.origin.as_dvec3() - a);
            assert!(
                (height / offset - 1.0).abs() < 1e-2,
                "{height} over the surface"
            );
            let d = ray.direction.as_dvec3();
            assert!((d.length() - 1.0).abs() < 2f64.powi(-22));
            assert!(side * normal.dot(d) > -1e-6);
            assert_eq!(ray.tmin, 0.0);
            let reach = match ray_type {
                RayType::AmbientOcclusion => (1e3 * offset) as f32,
                _ => f32::INFINITY,
            };
            assert_eq!(ray.tmax, reach);
        }
    }
}

#[test]
fn cosines_of_bounces_have_the_mean_of_a_cosine_distribution() {
    // A floor so large that every ray down hits it: normals are all +y.
    let floor = Mesh::new(vec![Triangle::new(
        Vec3::new(-1e4, 0.0, -1e4),
        Vec3::new(1e4, 0.0, -1e4),
        Vec3::new(0.0, 0.0, 1e4),
    )]);
    let down = Camera::new(DVec3::Y, DVec3::ZERO, DVec3::X, 90.0).unwrap();
    let film = Film::new(200, 200, 1).unwrap();
    let mut workload = Workload::new(&floor, View::of(down), film, 11).unwrap();
    for ray_type in [RayType::Diffuse(1), RayType::AmbientOcclusion] {
        let rays = workload
            .rays(ray_type, &mut |b| brute_force(&floor, b))
            .unwrap();
        let n = rays.batch.len() as f64;
        assert_eq!(n, 40_000.0);
        let sum: DVec3 = rays.batch.iter().map(|r| r.direction.as_dvec3()).sum();
        let mean = sum / n;
        // Variances: cos 1/2 − 4/9 = 1/18, the other axes 1/4.
        assert!(
            (mean.y - 2.0 / 3.0).abs() < 3.0 * (1.0 / 18.0 / n).sqrt(),
            "{mean}"
        );
        assert!(mean.x.abs() < 3.0 * (0.25 / n).sqrt(), "{mean}");
        assert!(mean.z.abs() < 3.0 * (0.25 / n).sqrt(), "{mean}");
        // Equal shares of the disc: the cosine's square is uniform.
        let mut share = [0u32; 10];
        for ray in rays.batch.iter() {
            share[((ray.direction.y * ray.direction.y * 10.0) as usize).min(9)] += 1;
        }
        assert!(share.iter().all(|&s| s.abs_diff(4000) < 240), "{share:?}");
    }
}

#[test]
fn shadow_rays_go_from_the_light_to_the_points() {
    let mesh = room();
    let film = Film::new(16, 16, 1).unwrap();
    let shadow = rays_of(&mesh, film, 0, RayType::ShadowPoint);
    let bounce = rays_of(&mesh, film, 0, RayType::Diffuse(1));
    assert_eq!(shadow.batch.len(), bounce.batch.len());
    assert_eq!(shadow.batch.shared_origin(), Some(LIGHT));
    for (i, (s, b)) in shadow.batch.iter().zip(bounce.batch.iter()).enumerate() {
        assert_eq!(shadow.primary(i), bounce.primary(i));
        assert_eq!((s.tmin, s.tmax), (0.0, 1.0 - 1e-4));
        assert_eq!(s.direction, b.origin - LIGHT);
    }
}

#[test]
fn area_shadow_rays_go_from_the_points_to_all_of_the_light() {
    let mesh = room();
    let film = Film::new(64, 64, 1).unwrap();
    let shadow = rays_of(&mesh, film, 0, RayType::ShadowArea);
    let bounce = rays_of(&mesh, film, 0, RayType::Diffuse(1));
    assert_eq!(shadow.batch.origin, bounce.batch.origin);
    let [e, f] = AREA.edges;
    let normal = e.cross(f);
    let mut quarters = [0usize; 4];
    for (i, ray) in shadow.batch.iter().enumerate() {
        assert_eq!(shadow.primary(i), bounce.primary(i));
        assert_eq!((ray.tmin, ray.tmax), (0.0, 1.0 - 1e-4));
        let target = ray.origin.as_dvec3() + ray.direction.as_dvec3() - AREA.corner;
        assert!(target.dot(normal.normalize()).abs() < 1e-6);
        let u = target.cross(f).dot(normal) / normal.length_squared();
        let v = e.cross(target).dot(normal) / normal.length_squared();
        assert!(u > -1e-6 && u < 1.0 + 1e-6 && v > -1e-6 && v < 1.0 + 1e-6);
        quarters[usize::from(u > 0.5) + 2 * usize::from(v > 0.5)] += 1;
    }
    let quarter = shadow.batch.len() / 4;
    assert!(quarters.iter().all(|&n| n.abs_diff(quarter) < quarter / 8));
}

#[test]
fn reflections_come_off_mirrors_and_nothing_else() {
    let mesh = room();
    let film = Film::new(64, 64, 1).unwrap();
    for view in [view(), view_with_lens()] {
        let mut workload = Workload::new(&mesh, view.clone(), film, 3).unwrap();
        let mut rays = |r| workload.rays(r, &mut |b| brute_force(&mesh, b)).unwrap();
        let camera = rays(view.camera_rays()).batch;
        let (bounce, reflected) = (rays(RayType::Diffuse(1)), rays(RayType::Reflection));
        let hits = brute_force(&mesh, &camera);
        // Two triangles of the floor in its plane, two of a wall by their numbers.
        let on_mirror = |i: usize| (1..5).contains(&hits.prim[i]);
        let expected: Vec<usize> = (0..bounce.batch.len())
            .filter(|&k| on_mirror(bounce.primary(k)))
            .collect();
        assert!(expected.len() > 500 && expected.len() < bounce.batch.len());
        assert_eq!(reflected.batch.len(), expected.len());
        for (k, ray) in reflected.batch.iter().enumerate() {
            let i = reflected.primary(k);
            assert_eq!(i, bounce.primary(expected[k]));
            assert_eq!(ray.origin, bounce.batch.ray(expected[k]).origin);
            assert_eq!((ray.tmin, ray.tmax), (0.0, f32::INFINITY));
            let incoming = camera.ray(i).direction;
            let mirrored = match hits.prim[i] {
                1 | 2 => incoming * Vec3::new(1.0, -1.0, 1.0),
                _ => incoming * Vec3::new(1.0, 1.0, -1.0),
            };
            assert!(ray.direction.distance(mirrored) < 1e-6);
        }
    }
}

#[test]
fn rays_through_the_lens_meet_the_pinhole_ray_in_the_plane_of_focus() {
    let mesh = room();
    let film = Film::new(30, 20, 4).unwrap();
    let mut workload = Workload::new(&mesh, view_with_lens(), film, 1).unwrap();
    let mut rays = |r| workload.rays(r, &mut |_| unreachable!()).unwrap().batch;
    let (pinhole, lens) = (rays(RayType::Primary), rays(RayType::Dof));
    assert_eq!(lens.len(), film.rays());
    assert_eq!(lens.shared_origin(), None);
    let eye = camera().eye().as_dvec3();
    let forward = (LOOK_AT.as_dvec3() - eye).normalize();
    let mut outer = 0;
    for (p, l) in pinhole.iter().zip(lens.iter()) {
        let from_eye = l.origin.as_dvec3() - eye;
        assert!(from_eye.length() < LENS.radius + 1e-6);
        assert!(from_eye.dot(forward).abs() < 1e-6);
        outer += u32::from(from_eye.length_squared() > 0.5 * LENS.radius * LENS.radius);
        let in_focus = |o: DVec3, d: Vec3| {
            let d = d.as_dvec3();
            o + d * ((LENS.focus - (o - eye).dot(forward)) / d.dot(forward))
        };
        let [a, b] = [
            in_focus(eye, p.direction),
            in_focus(l.origin.as_dvec3(), l.direction),
        ];
        assert!(a.distance(b) < 1e-5, "{a} {b}");
        assert!((l.direction.as_dvec3().length() - 1.0).abs() < 2f64.powi(-22));
    }
    // Half of the disc's area is outside of 1/sqrt 2 of its radius.
    assert!(outer.abs_diff(1200) < 120, "{outer}");
}

#[test]
fn generated_cameras_stand_in_a_room_and_around_an_object() {
    let mesh = room();
    let bounds = mesh.bounds();
    let mut nearest = |batch: &Batch| brute_force(&mesh, batch);
    let mut cameras = |eye| generated_cameras(&mesh, eye, DVec3::Y, 60.0, &mut nearest).unwrap();
    let inside = cameras(DVec3::new(-1.7, 2.2, 1.6));
    assert_eq!(
        inside,
        cameras(DVec3::new(-1.7, 2.2, 1.6)),
        "always the same"
    );
    assert_eq!(inside.len(), 16);
    for (i, camera) in inside.iter().enumerate() {
        let eye = camera.eye();
        assert!(eye.cmpgt(bounds.min).all() && eye.cmplt(bounds.max).all());
        assert!(inside[..i].iter().all(|other| other.eye() != eye));
        let ahead = Batch::from_iter([Ray::new(eye, camera.direction(0.5, 0.5, 1.0))]);
        assert!(brute_force(&mesh, &ahead).t[0] > 0.0);
    }
    let (middle, eye) = (bounds.center(), DVec3::new(0.0, 1.5, 9.0));
    let around = cameras(eye);
    assert_eq!(around.len(), 16);
    for camera in around {
        assert!((camera.eye().distance(middle) - 9.0).abs() < 1e-5);
        let towards = (middle - camera.eye()).normalize();
        assert!(camera.direction(0.5, 0.5, 1.0).distance(towards) < 1e-6);
    }
    let none = generated_cameras(
        &Mesh::default(),
        eye,
        DVec3::Y,
        60.0,
        &mut |_| unreachable!(),
    );
    assert_eq!(none, Ok(Vec::new()));
}

#[test]
fn random_rays_fill_the_box_and_the_sphere() {
    let mesh = room();
    let film = Film::new(100, 25, 4).unwrap();
    let rays = rays_of(&mesh, film, 5, RayType::Random);
    let n = film.rays();
    assert_eq!(rays.batch.len(), n);
    let bounds = mesh.bounds();
    let (mut origins, mut directions) = (DVec3::ZERO, DVec3::ZERO);
    for Ray {
        origin,
        direction,
        tmin,
        tmax,
    } in rays.batch.iter()
    {
        assert!(origin.cmpge(bounds.min).all() && origin.cmple(bounds.max).all());
        assert!((direction.as_dvec3().length() - 1.0).abs() < 2f64.powi(-22));
        assert_eq!((tmin, tmax), (0.0, f32::INFINITY));
        origins += ((origin - bounds.min) / bounds.extent()).as_dvec3() - 0.5;
        directions += direction.as_dvec3();
    }
    let n = n as f64;
    // Variances 1/12 and 1/3; four standard deviations, as there are six sums.
    assert!(
        (origins / n).abs().max_element() < 4.0 * (1.0 / 12.0 / n).sqrt(),
        "{origins}"
    );
    assert!(
        (directions / n).abs().max_element() < 4.0 * (1.0 / 3.0 / n).sqrt(),
        "{directions}"
    );
}

#[test]
fn same_bits_everywhere() {
    let mesh = room();
    let film = Film::new(20, 11, 4).unwrap();
    let all = RayType::ALL.into_iter();
    let mut found: Vec<_> = (all.filter(|r| *r != RayType::Dof))
        .map(|r| {
            let batch = rays_of(&mesh, film, 1, r).batch;
            (r.to_string(), batch.len(), fingerprint(&batch))
        })
        .collect();
    let mut through_lens = Workload::new(&mesh, view_with_lens(), film, 1).unwrap();
    found.extend(
        [RayType::Dof, RayType::Reflection, RayType::Diffuse(2)].map(|r| {
            let mut nearest = |batch: &Batch| brute_force(&mesh, batch);
            let batch = through_lens.rays(r, &mut nearest).unwrap().batch;
            (format!("lens {r}"), batch.len(), fingerprint(&batch))
        }),
    );
    let expected = [
        ("primary", 880, 0xc2800aebffa07458),
        ("shadow-point", 780, 0xed213410709f3947),
        ("shadow-area", 780, 0x77998551dbec119a),
        ("reflection", 330, 0x8a321cf40c49f594),
        ("ambient-occlusion", 780, 0x90ddbad54c227781),
        ("diffuse-1", 780, 0x176e1969b92329e2),
        ("diffuse-2", 564, 0xf6c6cfa8dbf6198e),
        ("diffuse-3", 430, 0x89579c0509af0a4a),
        ("diffuse-4", 331, 0xa14db3d4a1f13d42),
        ("diffuse-5", 247, 0x64d60f80b1058b44),
        ("diffuse-6", 183, 0x27189d55027785dd),
        ("diffuse-7", 132, 0x863e3ca4879afa84),
        ("diffuse-8", 106, 0x736a89e8ab4cd7f9),
        ("random", 880, 0x3bed1c0786839750),
        ("lens dof", 880, 0xd11bd35635712bae),
        ("lens reflection", 330, 0x9e59fdc6b4106840),
        ("lens diffuse-2", 563, 0xf46420273ec8231b),
    ];
    let expected: Vec<_> = expected.map(|(name, n, f)| (name.to_string(), n, f)).into();
    assert_eq!(found, expected, "{found:x?}");
}

#[test]
fn bounces_are_the_same_in_whatever_order_and_none_is_traced_twice() {
    let mesh = room();
    let film = Film::new(10, 10, 1).unwrap();
    let fresh: Vec<_> = (1..=MAX_BOUNCES)
        .map(|n| fingerprint(&rays_of(&mesh, film, 2, RayType::Diffuse(n)).batch))
        .collect();
    let mut workload = Workload::new(&mesh, view(), film, 2).unwrap();
    let mut calls = 0;
    let mut rays = |ray_type| {
        let mut nearest = |batch: &Batch| {
            calls += 1;
            brute_force(&mesh, batch)
        };
        let rays = workload.rays(ray_type, &mut nearest).unwrap();
        (fingerprint(&rays.batch), calls)
    };
    assert_eq!(rays(RayType::Primary).1, 0);
    assert_eq!(rays(RayType::ShadowPoint).1, 1);
    assert_eq!(rays(RayType::AmbientOcclusion).1, 1);
    for n in 1..=MAX_BOUNCES {
        let same = fresh[n as usize - 1];
        assert_eq!(rays(RayType::Diffuse(n)), (same, u32::from(n)));
        assert_eq!(rays(RayType::Diffuse(n)), (same, u32::from(n)));
    }
    assert_eq!(rays(RayType::Diffuse(1)), (fresh[0], 8));
    assert_eq!(rays(RayType::Diffuse(8)), (fresh[7], 8));
    assert_eq!(rays(RayType::Diffuse(3)), (fresh[2], 10));
}

#[test]
fn draws_depend_on_the_primary_ray_not_on_how_many_are_left() {
    let mesh = room();
    let film = Film::new(12, 12, 1).unwrap();
    let whole = rays_of(&mesh, film, 9, RayType::Diffuse(1));
    // Half of the primary rays lose their hit.
    let half = Workload::new(&mesh, View::of(camera()), film, 9)
        .unwrap()
        .rays(RayType::Diffuse(1), &mut |batch| {
            let mut hits = brute_force(&mesh, batch);
            for i in (0..batch.len()).step_by(2) {
                hits.t[i] = f32::INFINITY;
                hits.prim[i] = dacrt::rays::MISS;
            }
            hits
        })
        .unwrap();
    let odd: Vec<_> = (0..whole.batch.len())
        .filter(|&i| whole.primary(i) % 2 == 1)
        .collect();
    assert_eq!(half.batch.len(), odd.len());
    for (k, i) in odd.into_iter().enumerate() {
        assert_eq!(half.batch.ray(k), whole.batch.ray(i));
        assert_eq!(half.primary(k), whole.primary(i));
    }
}

#[test]
fn seed_steers_bounces_and_random_rays_alone() {
    let mesh = room();
    let film = Film::new(8, 8, 1).unwrap();
    let differ = |r| {
        fingerprint(&rays_of(&mesh, film, 1, r).batch)
            != fingerprint(&rays_of(&mesh, film, 2, r).batch)
    };
    for ray_type in [
        RayType::Diffuse(1),
        RayType::Diffuse(2),
        RayType::AmbientOcclusion,
        RayType::Random,
    ] {
        assert!(differ(ray_type), "{ray_type}");
    }
    assert!(!differ(RayType::Primary) && !differ(RayType::ShadowPoint));
    // Kinds of rays do not share their draws.
    let [a, b] =
        [RayType::Diffuse(1), RayType::AmbientOcclusion].map(|r| rays_of(&mesh, film, 1, r).batch);
    assert!(a.direction != b.direction);
}

#[test]
fn nothing_in_view_makes_empty_batches() {
    let away = Camera::new(
        DVec3::new(0.0, 10.0, 0.0),
        DVec3::new(0.0, 20.0, 0.0),
        DVec3::X,
        60.0,
    )
    .unwrap();
    let film = Film::new(8, 8, 1).unwrap();
    for (mesh, random) in [(room(), 64), (Mesh::default(), 0)] {
        let camera = away.with_lens(LENS).unwrap();
        let mut workload = Workload::new(&mesh, View { camera, ..view() }, film, 0).unwrap();
        for ray_type in RayType::ALL {
            let rays = workload
                .rays(ray_type, &mut |b| brute_force(&mesh, b))
                .unwrap();
            let expected = match ray_type {
                RayType::Primary | RayType::Dof => 64,
                RayType::Random => random,
                _ => 0,
            };
            assert_eq!(rays.batch.len(), expected, "{ray_type}");
            assert!(rays.batch.iter().all(|r| r.is_valid()));
        }
    }
}

#[test]
fn a_hit_on_a_triangle_without_a_normal_does_not_panic() {
    let mesh = Mesh::new(vec![Triangle::new(Vec3::ONE, Vec3::ONE, Vec3::ZERO)]);
    let film = Film::new(2, 2, 1).unwrap();
    let rays = Workload::new(&mesh, View::of(camera()), film, 0)
        .unwrap()
        .rays(RayType::Diffuse(1), &mut |b| Hits {
            t: vec![1.0; b.len()],
            prim: vec![0; b.len()],
        })
        .unwrap();
    assert!(rays.batch.iter().all(|r| r.is_valid()));
}

#[test]
fn what_cannot_be_is_said_clearly() {
    let mesh = room();
    let film = Film::new(8, 8, 1).unwrap();
    let mut workload = Workload::new(&mesh, View::of(camera()), film, 0).unwrap();
    let mut message = |r| {
        workload
            .rays(r, &mut |b| brute_force(&mesh, b))
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        message(RayType::ShadowPoint),
        "shadow-point rays need a point light, and there is none"
    );
    assert_eq!(
        message(RayType::ShadowArea),
        "shadow-area rays need an area light, and there is none"
    );
    assert_eq!(
        message(RayType::Reflection),
        "reflection rays need mirrors, and there is none"
    );
    assert_eq!(
        message(RayType::Dof),
        "dof rays need a camera with a lens, and there is none"
    );
    assert_eq!(message(RayType::Diffuse(0)), "bounce 0, expected 1 to 8");
    assert_eq!(message(RayType::Diffuse(9)), "bounce 9, expected 1 to 8");

    let film = |w, h, spp| Film::new(w, h, spp).unwrap_err().to_string();
    assert_eq!(
        film(0, 8, 1),
        "the resolution is 0x8, expected at least 1x1"
    );
    assert_eq!(
        film(8, 0, 1),
        "the resolution is 8x0, expected at least 1x1"
    );
    assert!(film(8, 8, 0).starts_with("0 samples per pixel, expected a square number"));
    assert!(film(8, 8, 8).starts_with("8 samples per pixel, expected a square number"));
    assert!(film(u32::MAX, u32::MAX, 4).contains("expected less than 2^32 - 1"));
    assert!(film(65_535, 65_537, 1).starts_with("4294967295 rays"));

    let camera = |eye, at, up, fov| Camera::new(eye, at, up, fov).unwrap_err().to_string();
    let (o, x, y) = (DVec3::ZERO, DVec3::X, DVec3::Y);
    assert_eq!(
        camera(x, x, y, 60.0),
        "the camera's eye and look-at are the same point, [1, 0, 0]"
    );
    assert!(camera(o, x, -2.0 * x, 60.0).contains("parallel to its view direction"));
    assert!(camera(o, x, o, 60.0).contains("up, [0, 0, 0], is zero"));
    for fov in [0.0, -5.0, 180.0, f64::NAN, f64::INFINITY] {
        assert!(camera(o, x, y, fov).contains("expected more than 0 and less than 180"));
    }
    assert_eq!(
        camera(DVec3::NAN, x, y, 60.0),
        "the camera's eye is not finite in float32"
    );
    assert_eq!(
        camera(o, x, y * f64::INFINITY, 60.0),
        "the camera's up is not finite in float32"
    );
    let broken = |change: &dyn Fn(&mut View)| {
        let mut view = view();
        change(&mut view);
        let film = Film::new(1, 1, 1).unwrap();
        Workload::new(&mesh, view, film, 0).err()
    };
    let light = broken(&|view| view.point_light = Some(Vec3::NAN));
    assert!(matches!(light, Some(WorkloadError::Light(_))));
    let edges = [DVec3::X, DVec3::splat(1e300)];
    let light = broken(&|view| view.area_light = Some(AreaLight { edges, ..AREA }));
    assert!(matches!(light, Some(WorkloadError::Light(_))));
    let (point, normal) = (DVec3::ZERO, DVec3::ZERO);
    let mirror = broken(&|view| view.mirrors = vec![Mirror::Plane { point, normal }]);
    assert!(matches!(mirror, Some(WorkloadError::Mirror(..))));
    for (radius, focus) in [
        (0.0, 1.0),
        (1.0, -1.0),
        (f64::NAN, 1.0),
        (1.0, f64::INFINITY),
    ] {
        let lens = self::camera().with_lens(Lens { radius, focus });
        assert!(matches!(lens.err(), Some(WorkloadError::Lens(_))));
    }
}
